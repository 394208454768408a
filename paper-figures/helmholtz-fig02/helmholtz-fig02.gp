# A line per solver, a column per time.
cell_width = 150.0
cell_height = 150.0
array step[4] = [1, 1, 1, 1]
gap = 30.0
set cbtics ('water' 1520.4, 'viscous' 1520.6)
load shared.'frames.gp'
