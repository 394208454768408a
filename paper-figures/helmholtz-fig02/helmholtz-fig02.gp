# A line per solver, a column per time.
cell_width = 150.0
cell_height = 150.0
array step[4] = [1, 1, 1, 1]
left = 180.0
set format cb ''
load shared.'frames.gp'
