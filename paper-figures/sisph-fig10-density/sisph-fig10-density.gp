# Columns coloured by density.
cell_width = 150.0
cell_height = 270.0
across = 6
step = 0.1
colour_low = 1; colour_high = 2
array window[4] = [-0.01, 0.21, -0.01, 0.385]
load shared.'matrix.gp'
