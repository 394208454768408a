# Three particles at five times.
cell_width = 180.0
cell_height = 36.0
array step[5] = [0.01, 0.01, 0.01, 0.01, 0.01]
load shared.'frames.gp'
