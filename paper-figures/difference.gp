# Two panels of what analysis/figures/difference.c measures; the first run is what the others are
# compared with.
width = 1200; height = 420
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.065,0.75,0.219,0.9 spacing 0.08
set xlabel label_x
set yrange [0:*]
unset key
set title 'difference of velocities, relative [1]' offset 0,-0.4
plot for [k = 2:n] file[k] using 1:2 with linespoints ls 200 + k title title[k]
set title 'share of the mass that is elsewhere [1]' offset 0,-0.4
set key at screen 0.76, screen 0.92 left top vertical Left reverse font ',11'
plot for [k = 2:n] file[k] using 1:3 with linespoints ls 200 + k title title[k]
unset multiplot
