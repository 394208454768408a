# Dam breaks in 3-D from the side: a line per run.
cell_width = 270.0
cell_height = 135.0
across = 3
step = 0.4
upward = 'z [m]'
load shared.'matrix.gp'
