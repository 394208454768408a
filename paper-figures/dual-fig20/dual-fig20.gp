width = 860; height = 480
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
load shared.'curves.gp'
set yrange [0:*]
plot for [k = 1:n] file[k] using 1:2 with lines ls 200 + k title title[k]
