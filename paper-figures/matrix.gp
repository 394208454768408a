# One picture per run, or per run and time, in lines of `across`; particles coloured by one
# quantity, equal axes, the same colour scale everywhere. A script sets cell_width and cell_height
# [px] of a picture, across and the step [m] of the axes' marks, and then loads this file. Where a
# program wrote x, y and the quantity, one file for each run, it sets colour_low, colour_high and
# array window[4] as well; in 3-D, upward = 'z [m]'. What a picture shows stands above it.

load 'contents.gp'
label_up = exists('upward') ? upward : 'y [m]'
if (!exists('rows')) {
  rows = n; columns = 1; walls = ''
  array row[n]
  array note[n]
  do for [k = 1:n] { row[k] = title[k]; note[k] = '' }
}
cells = rows*columns
across = cells < across ? cells : across
lines = (cells + across - 1)/across
left = 76.0; right = 130.0; top = 34.0; bottom = 84.0; gap_x = 14.0; gap_y = 30.0
width = left + right + across*cell_width + (across - 1)*gap_x
height = top + bottom + lines*cell_height + (lines - 1)*gap_y
load shared.'style.gp'

px_of_mark = 7.0 # how wide a mark of size 1 is, in both terminals
nothing = '/dev/null'
unset key
unset grid
set border 15
set colorbox vertical user origin screen 1 - (right - 20)/width, bottom/height \
  size screen 16/width, (height - top - bottom)/height
set cbrange [colour_low:colour_high]

set multiplot
do for [cell = 1:cells] {
  r = (cell - 1)/columns + 1
  c = (cell - 1)%columns + 1
  line = (cell - 1)/across
  place = (cell - 1)%across
  x0 = window[4*c - 3]; x1 = window[4*c - 2]; y0 = window[4*c - 1]; y1 = window[4*c]
  set lmargin at screen (left + place*(cell_width + gap_x))/width
  set rmargin at screen (left + place*(cell_width + gap_x) + cell_width)/width
  high = 1 - (top + line*(cell_height + gap_y))/height
  set tmargin at screen high
  set bmargin at screen high - cell_height/height
  set xrange [x0:x1]
  set yrange [y0:y1]
  set xtics step scale 0.5 offset 0,0.3
  set ytics step scale 0.5 offset 0.5,0
  if (cell + across > cells) { set format x '%g'; set xlabel 'x [m]' offset 0,0.7 } \
    else { set format x ''; unset xlabel }
  if (place == 0) { set format y '%g'; set ylabel label_up offset 0.5,0 } \
    else { set format y ''; unset ylabel }
  unset label
  about = columns == 1 ? row[r] : sprintf('t = %g s', time[c])
  if (columns > 1 && c == 1) { about = row[r].', '.about }
  set label 2 about \
    at graph 0, screen high + 10/height left noenhanced \
    font (7.4*strlen(about) < cell_width ? ',11' : ',9')
  set label 99 size_note at screen 0.995, screen 10/height right noenhanced font ',9' \
    textcolor rgb '#666666'
  if (cell == 1) { set label 4 label_colour at screen 1 - 12/width, screen 0.5 center rotate }
  if (note[cell] ne '') {
    set label 3 note[cell] at graph 0.5, graph 0.5 center font ',11' textcolor rgb '#666666'
  }
  mark = spacing*cell_width/(x1 - x0)/px_of_mark
  mark = mark < 0.25 ? 0.25 : mark
  plot (walls ne '' ? walls : nothing) using 1:2 with points pt 7 ps 0.8*mark lc rgb '#b9bec4', \
    (file[cell] ne '' ? file[cell] : nothing) using 1:2:3 with points pt 7 ps mark lc palette
  unset colorbox
}
unset multiplot
