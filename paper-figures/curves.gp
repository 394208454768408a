# One curve per run in a plot of its own; a script sets width and height [px], loads style.gp,
# contents.gp and this file, and plots.
set xlabel label_x
set ylabel label_y
set key outside right top vertical maxcols 1 Left reverse font ',11' spacing 1
