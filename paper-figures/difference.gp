# Two panels of what analysis/figures/difference.c measures; the first run is what the others are
# compared with. A script sets one_solver = 0 where solvers are compared.
width = 1200; height = 420
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
if (!exists('one_solver')) { one_solver = 1 }
set multiplot layout 1,2 margins 0.065,0.75,0.219,0.9 spacing 0.08
set xlabel label_x
set yrange [0:*]
unset key
set title 'difference of velocities, relative [1]' offset 0,-0.4
array line[n]
do for [k = 1:n] {
  line[k] = one_solver ? 200 + k : 300 + k
  if (!one_solver) { set style line 300 + k linetype colour[k] }
}
plot for [k = 2:n] file[k] using 1:2 with linespoints ls line[k] title title[k]
set title 'share of the mass that is elsewhere [1]' offset 0,-0.4
set key at screen 0.76, screen 0.92 left top vertical Left reverse font ',11'
plot for [k = 2:n] file[k] using 1:3 with linespoints ls line[k] title title[k]
unset multiplot
