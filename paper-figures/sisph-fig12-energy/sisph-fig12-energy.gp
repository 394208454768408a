width = 1200; height = 420
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.07,0.88,0.219,0.9 spacing 0.09
set logscale x
set xlabel label_x
set yrange [0:*]
unset key
set title 'kinetic energy at the end [J]' offset 0,-0.4
plot for [k = 1:n] file[k] using 1:2 with linespoints lt colour[k] title title[k]
set title 'time per iteration [ms]' offset 0,-0.4
set key at screen 0.89, screen 0.92 left top vertical Left reverse
plot for [k = 1:n] file[k] using 1:(1000*$3) with linespoints lt colour[k] title title[k]
unset multiplot
