width = 860; height = 480
load shared.'style.gp'
load 'contents.gp'
load shared.'curves.gp'
set yrange [0:*]
# the sample at the start comes before the first step
plot for [k = 1:n] file[k] every ::1 using 1:2 with lines lt colour[k] title title[k]
