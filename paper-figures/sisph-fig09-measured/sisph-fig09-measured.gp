one_solver = 0
load shared.'difference.gp'
