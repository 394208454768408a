# Pressures of a block after its release, from negative (dark red) over none (white) to positive.
cell_width = 190.0
cell_height = 281.2
across = 6
step = 0.2
load shared.'matrix.gp'
