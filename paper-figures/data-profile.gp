# Data profile (More & Wild 2009): the part of the problems that a solver solves with so many
# neighbour pairs visited per particle; sphbench profile writes the data.
width = 900; height = 520
load shared.'style.gp'
load 'contents.gp'
set logscale x
set format x '10^{%T}'
set xlabel 'neighbour pairs visited per particle'
set ylabel sprintf('part of %d problems solved', problems)
set key outside right top vertical Left reverse
set xrange [*:last_pairs*1.1]
set yrange [0:1.02]
plot for [k = 1:n] data[k] using 1:2 with steps linetype colour[k] title title[k]
