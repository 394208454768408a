# Error against neighbour pairs visited, which no machine changes; sphbench precision writes the
# data.
load 'contents.gp'
cost = 5; bar_low = 5; bar_high = 5
cost_low = pairs_low; cost_high = pairs_high
chosen(k) = pairs_front[k]
label_cost = 'neighbour pairs visited'
load shared.'precision.gp'
