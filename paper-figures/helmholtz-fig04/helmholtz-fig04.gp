# A line per solver, a column per time.
cell_width = 190.0
cell_height = 175.0
array step[4] = [1, 1, 1, 1]
upward = 'z [m]'
load shared.'frames.gp'
