width = 1400; height = 420
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.075,0.8,0.219,0.9 spacing 0.045
array panel[3] = ['nearer than 0.5 dx', 'pressed together by the flow', \
  'nearer, where the flow does not press']
set xlabel label_x
set yrange [0:1]
unset key
do for [c = 1:3] {
  set title panel[c] offset 0,-0.4 font ',12'
  set ylabel (c == 1 ? label_y : '')
  if (c == 3) { set key at screen 0.81, screen 0.92 left top vertical Left reverse font ',11' }
  plot for [k = 1:n] file[k] using 1:(column(c + 1)) with lines lt colour[k] title title[k]
}
unset multiplot
