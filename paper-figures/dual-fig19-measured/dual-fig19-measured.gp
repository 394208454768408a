one_solver = 1
load shared.'coherence.gp'
