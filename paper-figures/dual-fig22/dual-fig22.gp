# Dam breaks in 3-D from the side: a line per method.
cell_width = 250.0
cell_height = 133.7
across = 4
step = 0.4
upward = 'z [m]'
load shared.'matrix.gp'
