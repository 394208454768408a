width = 1320; height = 440
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,3 margins 0.065,0.79,0.2,0.89 spacing 0.07
set xlabel label_x
set xtics 0.05
set mxtics 5
set format y '%g'
unset key
array panel[3] = ['d_{ij}, to the left [m]', 'd_{ik}, to the right [m]', \
  'difference d_{ik} - d_{ij} [m]']
do for [c = 1:3] {
  set title panel[c] offset 0,-0.4
  if (c == 3) {
    set xzeroaxis linetype -1 linewidth 0.8
    set key at screen 0.8, screen 0.89 left top vertical maxcols 1 Left reverse \
      font ',10' spacing 0.95
  }
  plot for [k = 1:n] file[k] using 1:(column(c + 1)) with linespoints lt colour[k] \
    pointinterval 12 title title[k]
}
unset multiplot
