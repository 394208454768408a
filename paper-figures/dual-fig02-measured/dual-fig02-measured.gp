width = 1060; height = 420
load shared.'style.gp'
load 'contents.gp'
set multiplot layout 1,2 margins 0.08,0.84,0.219,0.9 spacing 0.09
array panel[2] = ['clumped [1]', 'negative pressure [1]']
set xlabel label_x
unset key
do for [c = 1:2] {
  set title panel[c] offset 0,-0.4
  if (c == 2) { set key at screen 0.855, screen 0.9 left top vertical Left reverse }
  plot for [k = 1:n] file[k] using 1:(column(c + 3)) with lines lt colour[k] title title[k]
}
unset multiplot
