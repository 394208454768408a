# The largest stable time step of each solver, why a longer one fails, and what theory allows.
width = 820; height = 190
load 'contents.gp'
height = 150 + 34*n
load shared.'style.gp'
set logscale x
set xlabel 'time step [ms]'
set format x '%g'
set title scene noenhanced
set yrange [n + 0.7:0.3]
set ytics scale 0 noenhanced
set ytics ('' 0)
do for [k = 1:n] { set ytics add (solver[k] k) }
set lmargin 16
set xrange [1e3*limits_low:1e3*limits_high]
set key below noenhanced
do for [e = -3:4] { set xtics add (2.*10**e, 5.*10**e) }
why(text) = text eq '' ? '' : '  '.text
plot 'limits.dat' using (1e3*$2):1:5 with points pointtype 7 pointsize 1.6 linecolor variable \
    title 'largest stable', \
  '' using (1e3*$2):1:(why(strcol(7))) with labels left offset 0.7,0 \
    font ',11' textcolor '#555555' notitle, \
  '' using (1e3*$4):1 with points pointtype 124 pointsize 1.6 linewidth 3 linecolor rgb '#000000' \
    title 'predicted'
