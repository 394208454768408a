width = 1320; height = 420
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.06,0.985,0.219,0.9 spacing 0.06
array panel[3] = ['momentum per depth [kg/s]', 'kinetic energy per depth [J/m]', \
  'energy gained [J/m]']
set xlabel label_x
unset key
do for [c = 1:3] {
  set title panel[c] offset 0,-0.4
  if (c == 3) { set key at graph 1, graph 0.3 right top font ',11' }
  if (c < 3) { set logscale y; set format y '10^{%L}' } else { unset logscale; set format y '%g' }
  plot for [k = 1:n] file[k] using 1:(column(c + 1)) with lines ls 200 + k title title[k]
}
unset multiplot
