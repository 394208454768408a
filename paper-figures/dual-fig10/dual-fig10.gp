# Square patch: solvers of the paper at every time, with the exact free surface where it is known.
cell_width = 170.0
cell_height = 170.0
array step[4] = [0.2, 0.3, 0.5, 0.5]
load shared.'frames.gp'
