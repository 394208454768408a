width = 1100; height = 430
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.075,0.985,0.27,0.91 spacing 0.085
set xlabel label_x
set xtics 0.02
set format y '%g'
unset key
array panel[3] = ['d_{ij}, to the left [m]', 'd_{ik}, to the right [m]', 'd_{ik} - d_{ij} [m]']
do for [c = 1:3] {
  set title panel[c]
  if (c == 3) { set xzeroaxis linecolor rgb '#000000' linewidth 1 }
  if (c == 2) {
    set key at screen 0.5, screen 0.03 center bottom horizontal maxrows 1 width 2
  } else { unset key }
  plot for [k = 1:n] file[k] using 1:(column(c + 1)) with linespoints lt colour[k] \
    pointinterval 12 title title[k]
}
unset multiplot
