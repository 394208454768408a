# Distances of three particles: above the outer ones are driven, below only pushed at the start.
width = 1320; height = 720
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 2,3 margins 0.065,0.79,0.128,0.94 spacing 0.085,0.12
set xtics 0.05
set tics font ',12'
set mxtics 5
set format y '%g'
array panel[3] = ['d_{ij}, to the left [m]', 'd_{ik}, to the right [m]', \
  'difference d_{ik} - d_{ij} [m]']
array ends[2] = ['ends driven', 'ends free']
do for [r = 1:2] {
  low = r == 1 ? 1 : 8
  high = r == 1 ? 7 : n
  do for [c = 1:3] {
    set title panel[c].", ".ends[r] offset 0,-0.6 font ',12'
    set xlabel (r == 2 ? label_x : '')
    unset key
    if (c == 3) {
      set xzeroaxis linetype -1 linewidth 0.8
      top_of_key = r == 1 ? 0.94 : 0.45
      set key at screen 0.8, screen top_of_key left top vertical Left reverse font ',12'
    } else { unset xzeroaxis }
    plot for [k = low:high] file[k] using 1:(column(c + 1)) with linespoints lt colour[k] \
      pointinterval 12 title title[k]
  }
}
unset multiplot
