# A line per solver, a column per time.
cell_width = 230.0
cell_height = 119.0
array step[4] = [0.5, 0.5, 0.5, 0.5]
upward = 'z [m]'
load shared.'frames.gp'
