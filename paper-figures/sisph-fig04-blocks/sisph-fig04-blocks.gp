width = 1060; height = 420
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.08,0.965,0.219,0.9 spacing 0.09
array panel[2] = ['momentum [kg m/s]', 'kinetic energy [J]']
set xlabel label_x
set key center right
do for [c = 1:2] {
  set title panel[c] offset 0,-0.4
  if (c == 1) { set logscale y; set format y '10^{%L}' } else { unset logscale; set format y '%g' }
  plot for [k = 1:n] file[k] using 1:(column(c + 1)) with lines ls 200 + k title title[k]
}
unset multiplot
