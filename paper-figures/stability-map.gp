# Time step by one parameter more, one panel for each solver; the colour is the worst criterion that
# a run broke, the black line what theory allows.
load 'contents.gp'
columns = n < 3 ? n : 3
rows = (n + columns - 1)/columns
width = 120 + 330*columns; height = 110 + 260*rows
load shared.'style.gp'
set logscale x
if (is_log) { set logscale y }
set format x '%g'
unset key
set xrange [dt_low:dt_high]
set yrange [value_low:value_high]
set style fill solid 1 noborder
unset ytics
do for [k = 1:num_rows] { set ytics add (row_label[k] row_at[k]) }
set ytics noenhanced
unset grid
set multiplot layout rows,columns margins 0.09, 0.97, 0.16 + 0.05/rows, 0.94 - 0.03/rows \
  spacing 0.07, 0.13 title scene noenhanced
do for [k = 1:n] {
  set title name[k] noenhanced offset 0,-0.6
  if (k > n - columns) { set xlabel 'time step [s]' offset 0,0.5 } else { unset xlabel }
  if (k % columns == 1 || columns == 1) { set ylabel label_value noenhanced } else { unset ylabel }
  plot cells[k] using 1:2:3:4:5:6:7 with boxxyerror linecolor rgb variable notitle, \
    line[k] using 1:2 with lines linewidth 2.5 linecolor rgb '#000000' notitle
}
unset multiplot
