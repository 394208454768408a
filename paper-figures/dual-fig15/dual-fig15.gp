# Dam breaks in 3-D from the side, a line per run.
cell_width = 260.0
cell_height = 139.4
across = 3
step = 0.2
upward = 'z [m]'
load shared.'matrix.gp'
