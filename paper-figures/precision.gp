# Error against a cost, for each solver all its points and their Pareto front. A script sets cost,
# bar_low, bar_high (columns: the cost and its interval), cost_low, cost_high (of all), chosen(k)
# (file of the front) and label_cost, and loads this.
#
# Failed runs have neither error nor cost: they stand in the margin at the top, one cross each.
width = 1080; height = 620
load shared.'style.gp'
set logscale xy
set format y '%g'
set format x '%g'
set xlabel label_cost
set ylabel label_error noenhanced
x_low = cost_low; x_high = cost_high; y_low = error_low; y_high = error_high
load shared.'log-tics.gp'
set title scene noenhanced
set key outside right top vertical Left reverse
set xrange [cost_low/1.3:cost_high*1.3]
top = num_failed > 0 ? (error_high/error_low)**0.09 : 1
set yrange [error_low/1.3:error_high*1.3*top]
set style line 101 linecolor rgb '#999999' linewidth 1 dashtype (3,3)
do for [target in '0.1 0.03 0.01'] {
  if (target + 0 > error_low/1.3 && target + 0 < error_high*1.3) {
    set arrow from graph 0, first target + 0 to graph 1, first target + 0 nohead linestyle 101 back
    set label sprintf('%g %%', 100*target) at graph 1, first target + 0 right offset -0.3, 0.5 \
      font ',11' textcolor rgb '#777777'
  }
}
if (num_failed > 0) {
  set object rectangle from graph 0, 0.93 to graph 1, 1 fillcolor rgb '#f2e7e4' fillstyle solid \
    noborder behind
  set label 'failed' at graph 0.01, 0.965 font ',11' textcolor rgb '#a3290f'
}
set x2range [0:1]
set y2range [0:1]
place(i) = 0.08 + 0.91*(i - 0.5)/num_failed
some = ''; fronts = ''
s(i) = i > words(some) ? 1 : int(word(some, i)) # also asked where there is none
f(i) = i > words(fronts) ? 1 : int(word(fronts, i))
do for [k = 1:n] {
  if (file[k] ne '') { some = some.sprintf(' %d', k) }
  if (chosen(k) ne '') { fronts = fronts.sprintf(' %d', k) }
}
plot for [i = 1:words(some)] file[s(i)] using cost:4 with points linetype colour[s(i)] \
    pointsize 0.5 notitle, \
  for [i = 1:words(fronts)] chosen(f(i)) using cost:4 with linespoints linetype colour[f(i)] \
    pointsize 1 notitle, \
  for [i = 1:words(fronts)] chosen(f(i)) using cost:4:bar_low:bar_high with xerrorbars \
    linetype colour[f(i)] linewidth 1 dashtype solid pointsize 0 notitle, \
  for [k = 1:n] keyentry with linespoints linetype colour[k] title title[k], \
  for [k = 1:(num_failed > 0)] 'failed.dat' using (place($1)):(0.965):2 axes x2y2 with points \
    pointtype 2 pointsize 0.9 linewidth 2 linecolor variable notitle
