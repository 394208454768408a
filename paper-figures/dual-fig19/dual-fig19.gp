# Dam breaks in the plane: a line per method.
cell_width = 260.0
cell_height = 168.2
across = 3
step = 0.5
load shared.'matrix.gp'
