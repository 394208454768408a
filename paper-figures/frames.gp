# Rows of runs by columns of times; particles coloured by one quantity, equal axes, the same colour
# scale everywhere. A script sets cell_width and cell_height [px] of a picture and for each time the
# step [m] of the axes' marks, if need be `upward`, and then loads this file.

load 'contents.gp'
longest = 0
do for [r = 1:rows] { longest = strlen(row[r]) > longest ? strlen(row[r]) : longest }
left = 112.0 + 9.2*longest # room for the rows' labels [px]
right = 124.0; top = 40.0; bottom = 80.0
if (!exists('gap')) { gap = 12.0 }
width = left + right + columns*cell_width + (columns - 1)*gap
height = top + bottom + rows*cell_height + (rows - 1)*gap
load shared.'style.gp'

# How wide a mark of size 1 is [px], in both terminals.
px_of_mark = 7.0
nothing = '/dev/null'
y_label_offset = 0.3
if (!exists('upward')) { upward = 'y [m]' }
y_label = cell_height > 60 ? upward : ''
small = cell_width < 200 ? ',9' : ',11'

unset key
unset grid
set border 15
set colorbox vertical user origin screen 1 - (right - 20)/width, bottom/height \
  size screen 16/width, (height - top - bottom)/height
set cbrange [colour_low:colour_high]

x_of(c) = (left + (c - 1)*(cell_width + gap))/width
y_of(r) = 1 - (top + r*cell_height + (r - 1)*gap)/height

set multiplot
do for [r = 1:rows] {
  do for [c = 1:columns] {
    cell = (r - 1)*columns + c
    x0 = window[4*c - 3]; x1 = window[4*c - 2]; y0 = window[4*c - 1]; y1 = window[4*c]
    set lmargin at screen x_of(c)
    set rmargin at screen x_of(c) + cell_width/width
    set bmargin at screen y_of(r)
    set tmargin at screen y_of(r) + cell_height/height
    set xrange [x0:x1]
    set yrange [y0:y1]
    set xtics step[c] scale 0.5 offset 0,0.3
    set ytics step[c] scale 0.5 offset 0.5,0
    if (r == rows) { set format x '%g'; set xlabel 'x [m]' offset 0,0.7 } \
      else { set format x ''; unset xlabel }
    if (c == 1) { set format y '%g'; set ylabel y_label offset y_label_offset,0 } \
      else { set format y ''; unset ylabel }
    unset label
    if (r == 1) {
      set label 1 sprintf('t = %g s', time[c]) at graph 0.5, screen 1 - 0.5*top/height center
    }
    if (cell == 1) { set label 4 label_colour at screen 1 - 12/width, screen 0.5 center rotate }
    if (c == 1) { set label 2 row[r] at screen 8/width, graph 0.5 left noenhanced }
    if (note[cell] ne '') {
      set label 3 note[cell] at graph 0.5, graph 0.5 center font small textcolor rgb '#666666'
    }
    if (cell == rows*columns) {
      set label 99 size_note at screen 0.995, screen 10/height right font ',9' \
        textcolor rgb '#666666'
    }
    outline = 0
    do for [k = 1:num_overlays] { if (abs(overlay_time[k] - time[c]) < 1e-6) { outline = k } }
    # a particle is drawn as wide as its spacing, but not so small that it vanishes
    mark = spacing*cell_width/(x1 - x0)/px_of_mark
    mark = mark < 0.25 ? 0.25 : mark
    plot (walls ne '' ? walls : nothing) using 1:2 with points pt 7 ps 0.8*mark lc rgb '#b9bec4', \
      (file[cell] ne '' ? file[cell] : nothing) using 1:2:3 with points pt 7 ps mark lc palette, \
      (outline ? overlay_file[outline] : nothing) using 1:2 with lines ls 100
    unset colorbox
  }
}
unset multiplot
