width = 1400; height = 800
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 2,3 margins 0.085,0.79,0.115,0.95 spacing 0.045,0.15
array stiff[3] = ['0.8', '8', '81']
array way[8] = ['plain', 'Anderson-1', 'Anderson-2', 'Anderson-3', 'Anderson-4', 'Anderson-5', \
  'Chebyshev-0.9', 'Chebyshev-matched']
array axis[2] = [label_x, 'time [ms]']
set logscale y
set format y '10^{%L}'
set yrange [1e-6:1.5]
unset key
do for [c = 1:2] {
  do for [p = 1:3] {
    set title 'S = '.stiff[p] offset 0,-0.6
    set xlabel axis[c] offset 0,0.4
    set ylabel (p == 1 ? label_y : '')
    unset key
    if (c*p == 3) { set key at screen 0.8, screen 0.95 left top vertical Left reverse }
    plot for [k = 1:8] sprintf('sisph-S%s-%s.dat', stiff[p], way[k]) \
      using (c == 1 ? $1 : 1000*$4):2 with lines ls 200 + k title way[k]
  }
}
unset multiplot
