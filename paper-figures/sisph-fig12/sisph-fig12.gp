# The sheet after the ball, from the side: a line per solver, steps growing to the right.
cell_width = 170.0
cell_height = 153.0
across = 6
step = 0.5
upward = 'z [m]'
load shared.'matrix.gp'
