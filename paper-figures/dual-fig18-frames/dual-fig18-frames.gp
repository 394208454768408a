# Dam breaks in 3-D from the side: a line per solver, steps growing to the right.
cell_width = 230.0
cell_height = 123.3
across = 4
step = 0.2
upward = 'z [m]'
load shared.'matrix.gp'
