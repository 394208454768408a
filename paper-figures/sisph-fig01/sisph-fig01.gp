width = 1060; height = 440
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.09,0.98,0.209,0.9 spacing 0.1
set logscale xy
set format xy '10^{%L}'
set xlabel label_x
set ylabel label_y
set key bottom right
set title 'here, one thread' offset 0,-0.4
plot file[1] using 2:3 with linespoints lt colour[1] title 'per step', \
  '' using 2:4 with linespoints lt colour[1] + 20 title 'per iteration'
set title 'the paper' offset 0,-0.4
plot for [k = 1:num_overlays] overlay_file[k] using 1:2 with linespoints \
  lt colour_sisph + 20*(k - 1) title overlay_title[k]
unset multiplot
