# Error against run time; sphbench precision writes the data.
load 'contents.gp'
cost = 1; bar_low = 2; bar_high = 3
cost_low = time_low; cost_high = time_high
chosen(k) = front[k]
label_cost = 'run time [s]'
load shared.'precision.gp'
