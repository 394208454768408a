# Errors over spacing or time step with the fitted order of each solver and its interval of 95 %;
# bars: two standard deviations of the mean over starts. sphbench convergence writes the data.
width = 1000; height = 600
load shared.'style.gp'
load 'contents.gp'
set logscale xy
set format y '%g'
set format x '%g'
set xlabel label_x
set ylabel label_error noenhanced
set title scene noenhanced
set key outside right top vertical Left reverse
x_low = 1; x_high = 1000 # its tics are the levels
y_low = error_low; y_high = error_high
set xrange [h_low/1.15:h_high*1.15]
set yrange [error_low/1.5:error_high*1.5]
load shared.'log-tics.gp'
some = ''
s(i) = i > words(some) ? 1 : int(word(some, i))
do for [k = 1:n] { if (file[k] ne '') { some = some.sprintf(' %d', k) } }
plot for [i = 1:words(some)] file[s(i)] using 1:5 with lines linetype colour[s(i)] linewidth 1 \
    notitle, \
  for [i = 1:words(some)] file[s(i)] using 1:2:3:4 with yerrorbars linetype colour[s(i)] \
    linewidth 1.5 dashtype solid pointsize 1 notitle, \
  for [k = 1:n] keyentry with linespoints linetype colour[k] title title[k]
