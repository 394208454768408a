# Performance profile (Dolan & More 2002): the part of the problems that a solver solves within a
# factor of the fastest; sphbench profile writes the data.
width = 900; height = 520
load shared.'style.gp'
load 'contents.gp'
set logscale x 2
set format x '%g'
set xlabel 'run time over that of the fastest solver'
set ylabel sprintf('part of %d problems solved', problems)
set key outside right top vertical Left reverse
set xrange [1:last_ratio*1.1 + 0.01]
set yrange [0:1.02]
plot for [k = 1:n] performance[k] using 1:2 with steps linetype colour[k] title title[k]
