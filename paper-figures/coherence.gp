# Three panels of what analysis/figures/coherence.c measures. A script sets one_solver = 1 where the
# curves differ in a parameter and not in the solver.
width = 1400; height = 420
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.055,0.8,0.219,0.9 spacing 0.06
array panel[3] = ["variance of neighbours' velocities [1]", 'thin sheets [m^{d-1}]', \
  'share of particles nearer than 0.5 dx [1]']
set xlabel label_x
unset key
do for [c = 1:3] {
  set title panel[c] offset 0,-0.4
  if (c == 1) { set logscale y; set format y '10^{%L}' } else { unset logscale; set format y '%g' }
  if (c == 3) { set key at screen 0.81, screen 0.92 left top vertical Left reverse font ',11' }
  if (one_solver) {
    plot for [k = 1:n] file[k] using 1:(column(c + 1)) with lines ls 200 + k title title[k]
  } else {
    plot for [k = 1:n] file[k] using 1:(column(c + 1)) with lines lt colour[k] title title[k]
  }
}
unset multiplot
