# Dam break: every solver at every time, with its walls.
cell_width = 204.0
cell_height = 132.0
array step[5] = [0.5, 0.5, 0.5, 0.5, 0.5]
load shared.'frames.gp'
