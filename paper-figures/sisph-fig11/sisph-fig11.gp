# Tanks coloured by density.
cell_width = 280.0
cell_height = 280.0
across = 3
step = 0.1
colour_low = 1; colour_high = 2
array window[4] = [-0.02, 0.42, -0.02, 0.42]
load shared.'matrix.gp'
