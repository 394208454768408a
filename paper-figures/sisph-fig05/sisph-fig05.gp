width = 1400; height = 440
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.05,0.985,0.209,0.9 spacing 0.06
set key top left
set xlabel 'density over rest density λ [1]'
array about[2] = ['bulk energy B(λ)', "its slope B'(λ)"]
do for [c = 1:2] {
  set title about[c] offset 0,-0.4
  plot for [b = 0:2] sprintf('B%d.dat', b) using 1:(column(c + 1)) with lines ls 201 + b \
    title sprintf('B%d', b)
}
set title label_y offset 0,-0.4
set xlabel label_x
set logscale y
set format y '10^{%L}'
set yrange [1e-6:1.5]
set key bottom left font ',11'
array curve[5] = ['B0', 'B1', 'B2', 'B1-repaired', 'B2-repaired']
plot for [k = 1:5] sprintf('sisph-%s.dat', curve[k]) using 1:2 with lines ls 200 + k \
  title k == 1 ? 'B0' : k < 4 ? curve[k].', Eq. (20)' : curve[k], \
  for [k = 1:3] sprintf('sisph-%s.dat', curve[k]) using 1:3 with lines ls 200 + k \
  dt (1,3) lw 1.5 title k == 1 ? 'by Eq. (18)' : ''
unset multiplot
