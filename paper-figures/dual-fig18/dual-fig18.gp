width = 1200; height = 460
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.085,0.84,0.2,0.9 spacing 0.07
set ylabel label_y
set yrange [0:*]
set offsets graph 0.03, graph 0.03, 0, 0
set xlabel 'time step dt [ms]'
set title 'here' offset 0,-0.4
unset key
plot for [k = 1:n] file[k] using (1e3*$1):2 with linespoints lt colour[k] notitle, \
  for [k = 1:n] file[k] using (1e3*$1):($3 < 0.5 ? $2 : NaN) with points pt 2 ps 2 lw 2 \
  lc rgb '#000000' notitle
set title 'the paper' offset 0,-0.4
unset ylabel
set xrange [1.8:5.2]
set key at screen 0.855, screen 0.9 left top vertical Left reverse
array paper[5] = [colour_vssph, colour_dfsph, colour_dual_sa, colour_dual_sb, colour_dual_sc]
plot for [k = 1:num_overlays] overlay_file[k] using 1:2 with linespoints lt paper[k] \
  title overlay_title[k], NaN with points pt 2 ps 2 lw 2 lc rgb '#000000' title 'failed'
unset multiplot
