width = 860; height = 480
load shared.'style.gp'
load 'contents.gp'
set xlabel label_x
set ylabel label_y
set key outside right top vertical Left reverse
set logscale xy
set xrange [0.0022:0.0115]
set yrange [5e-5:2]
set format y '10^{%L}'
set xtics (0.0025, '' 0.00375, 0.005, '' 0.0075, 0.01)
set mytics 10
plot for [k = 1:n] file[k] using 1:2 with points lt colour[k] title title[k], \
  for [k = 1:n] (fit[k] ne '' ? fit[k] : '/dev/null') using 1:2 with lines lt colour[k] \
  linewidth 1.2 notitle
