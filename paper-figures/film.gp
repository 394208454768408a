# The frames of one result file, a picture each: particles coloured by one quantity, equal axes, the
# same window and colour scale in all. `sphbench frames` writes the data and contents.gp and starts
# this script in their folder. A film needs an even number of pixels each way.

load 'contents.gp'
kind = 'png'
picture = '0.png'
left = 84.0; right = 124.0; top = 36.0; bottom = 58.0; longest = 560.0
scale = longest/((x1 - x0) > (y1 - y0) ? x1 - x0 : y1 - y0)
room_x = scale*(x1 - x0) < 160 ? 160 : ceil(scale*(x1 - x0))
room_y = scale*(y1 - y0) < 160 ? 160 : ceil(scale*(y1 - y0))
width = left + right + room_x
height = top + bottom + room_y
load shared.'style.gp'

# the window grows to what the picture has room for, so that the axes stay equal
x_more = 0.5*(room_x/scale - (x1 - x0))
y_more = 0.5*(room_y/scale - (y1 - y0))
unset key
unset grid
set border 15
set lmargin at screen left/width
set rmargin at screen 1 - right/width
set bmargin at screen bottom/height
set tmargin at screen 1 - top/height
set xrange [x0 - x_more:x1 + x_more]
set yrange [y0 - y_more:y1 + y_more]
set xtics scale 0.5 offset 0,0.3
set ytics scale 0.5 offset 0.5,0
set xlabel 'x [m]' offset 0,0.7
set label 2 label_up at screen 16/width, graph 0.5 center rotate
set cbrange [colour_low:colour_high]
set label 3 label_colour at screen 1 - 14/width, graph 0.5 center rotate
set colorbox vertical user origin screen 1 - (right - 20)/width, bottom/height \
  size screen 14/width, room_y/height

# as wide as its spacing; a mark of size 1 is 7 px wide, as in frames.gp
mark = spacing*scale/7.0
mark = mark < 0.25 ? 0.25 : mark
nothing = '/dev/null'
do for [k = 1:frames] {
  set output sprintf('%d.png', k - 1)
  set label 1 sprintf('%s, t = %.4f s', title_text, time[k]) noenhanced \
    at screen left/width, screen 1 - 0.5*top/height left
  plot (walls ne '' ? walls : nothing) using 1:2 with points pt 7 ps 0.8*mark lc rgb '#b9bec4', \
    sprintf('%d.dat', k - 1) using 1:2:3 with points pt 7 ps mark lc palette
}
unset output
