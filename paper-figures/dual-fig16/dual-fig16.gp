# Dam breaks in 3-D from the side: inviscid above, viscous below.
cell_width = 230.0
cell_height = 123.3
across = 3
step = 0.2
upward = 'z [m]'
load shared.'matrix.gp'
