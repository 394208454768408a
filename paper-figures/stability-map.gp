# Time step by one parameter more, one panel for each solver; the colour is the worst criterion that
# a run broke, the black line what theory allows.
load 'contents.gp'
columns = n < 3 ? n : 3
rows = (n + columns - 1)/columns
# in pixels: a panel, what is below and above it, the title, the key
panel = num_rows < 3 ? 130. : num_rows < 6 ? 200. : 260.
below = 90.; head = 60.; foot = 60.
width = 120 + 330*columns; height = head + rows*(panel + below) + foot
load shared.'style.gp'
set logscale x
if (is_log) { set logscale y }
set format x '%g'
unset key
set xrange [1e3*dt_low:1e3*dt_high]
set yrange [value_low:value_high]
set style fill solid 1 noborder
unset ytics
tics = ''
do for [k = 1:num_rows] {
  tics = tics.sprintf("%s'%s' %.9g", k > 1 ? ', ' : '', row_label[k], row_at[k])
}
eval 'set ytics noenhanced ('.tics.')'
unset grid
do for [e = -3:4] { set xtics add (2.*10**e, 5.*10**e) }
set multiplot layout rows,columns margins 110./width, 1 - 30./width, \
  (foot + 60)/height, 1 - (head + 20)/height spacing 90./width, below/height
set label 1000 scene at screen 0.5, 1 - 18./height center noenhanced
key_y = 25./height
do for [k = 1:num_verdicts] {
  set label 1000 + k verdict[k] at screen 0.06 + 0.94*(k - 1)/(num_verdicts + 1), key_y \
    point pointtype 5 pointsize 2 linecolor rgb verdict_colour[k] offset 1.2, 0 font ',12'
}
set label 1100 'predicted limit' at screen 0.06 + 0.94*num_verdicts/(num_verdicts + 1), key_y \
  point pointtype 2 pointsize 0 offset 1.2, 0 font ',12'
set arrow 1100 from screen 0.045 + 0.94*num_verdicts/(num_verdicts + 1), key_y \
  rto screen 0.02, 0 nohead linewidth 2.5 linecolor rgb '#000000'
do for [k = 1:n] {
  set title name[k] noenhanced offset 0,-0.6
  if (k > n - columns) { set xlabel 'time step [ms]' offset 0,0.5 } else { unset xlabel }
  if (k % columns == 1 || columns == 1) { set ylabel label_value noenhanced } else { unset ylabel }
  plot cells[k] using (1e3*$1):2:(1e3*$3):(1e3*$4):5:6:7 with boxxyerror \
    linecolor rgb variable notitle, \
    line[k] using (1e3*$1):2 with lines linewidth 2.5 dashtype solid linecolor rgb '#000000' notitle
  unset for [j = 1000:1100] label j
  unset arrow 1100
}
unset multiplot
