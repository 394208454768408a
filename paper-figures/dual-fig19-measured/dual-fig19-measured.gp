one_solver = 0
load shared.'coherence.gp'
