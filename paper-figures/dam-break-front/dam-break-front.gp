width = 860; height = 480
load shared.'style.gp'
load 'contents.gp'
load shared.'curves.gp'
set xrange [0:4]
set yrange [1:5]
plot for [k = 1:n] file[k] using 1:2 with lines lt colour[k] title title[k], \
  for [k = 1:num_overlays] overlay_file[k] using 1:2 with points ls 100 title overlay_title[k]
