width = 760; height = 460
load shared.'style.gp'
load 'contents.gp'
load shared.'curves.gp'
set yrange [0:*]
plot for [k = 1:n] file[k] using 1:2 with linespoints lt colour[k] title title[k], \
  for [k = 1:n] file[k] using 1:($3 < 0.5 ? $2 : NaN) with points pt 2 ps 2 lw 2 \
  lc rgb '#000000' title k == 1 ? 'failed' : ''
