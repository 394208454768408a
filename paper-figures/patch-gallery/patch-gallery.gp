# Square patch: every solver at every time, with the exact free surface where it is known.
cell_width = 190.0
cell_height = 190.0
array step[5] = [0.1, 0.2, 0.3, 0.5, 0.5]
load shared.'frames.gp'
