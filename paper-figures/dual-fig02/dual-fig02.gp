# Pressures of a drop on a ball; what is dark is under tension.
cell_width = 240.0
cell_height = 222.9
across = 3
step = 0.1
load shared.'matrix.gp'
