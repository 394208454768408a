# Logarithmic axes from x_low to x_high and y_low to y_high: where there are hardly two powers of
# ten, tics at 2 and 5 of each as well.
more(low, high, e) = high/low < 200 && e >= floor(log10(low)) - 1 && e <= log10(high) + 1
do for [e = -20:20] {
  if (more(x_low, x_high, e)) { set xtics add (2.*10**e, 5.*10**e) }
  if (more(y_low, y_high, e)) { set ytics add (2.*10**e, 5.*10**e) }
}
