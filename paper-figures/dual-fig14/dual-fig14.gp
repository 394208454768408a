width = 1240; height = 880
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 2,2 margins 0.085,0.985,0.105,0.95 spacing 0.07,0.13
unset grid
unset key
set border 15
set xrange [-0.05:1.65]; set yrange [-0.05:1]
set xlabel label_x
mark = spacing*540/1.7/7
do for [k = 1:4] {
  set ylabel (k % 2 == 1 ? label_y : '')
  set title sprintf('t = %.1f s', 0.2*k) offset 0,-0.6
  plot sprintf('dual-sc-%d-virtual.dat', k) using 1:2 \
    with points pt 7 ps 0.6*mark lc rgb '#e05030', \
    sprintf('dual-sc-%d-real.dat', k) using 1:2 with points pt 7 ps 0.3*mark lc rgb '#000000'
}
unset multiplot
