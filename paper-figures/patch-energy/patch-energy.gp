width = 860; height = 480
load shared.'style.gp'
load 'contents.gp'
load shared.'curves.gp'
set yrange [0:4] # what diverges leaves the picture
plot for [k = 1:n] file[k] using 1:2 with lines lt colour[k] title title[k]
