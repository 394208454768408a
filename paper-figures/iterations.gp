# Algebraic error of one step over the iterations of each solver, with its mean factor of an
# iteration in the legend. sphbench convergence --over iterations writes the data.
width = 1000; height = 600
load shared.'style.gp'
load 'contents.gp'
set datafile separator comma
set logscale y
set format y '10^{%T}'
set xlabel 'iterations'
set ylabel 'velocity, relative distance from the converged step'
set title scene noenhanced
set key outside right top vertical Left reverse
set xrange [0:most*1.02]
set yrange [1e-10:*]
plot for [k = 1:n] 'iterations.csv' skip 1 \
    using 2:(strcol(1) eq solver[k] && $4 > 0 ? $4 : NaN) with linespoints \
    linetype colour[k] title title[k]
