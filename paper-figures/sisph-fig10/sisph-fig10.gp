width = 900; height = 500
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
load shared.'curves.gp'
set logscale xy
set format y '10^{%L}'
set format x '10^{%L}'
set xrange [50:2e6]
set yrange [1e-3:3]
array theory[3] = ['exact, modulus K', 'exact, K_eff of the lattice', 'exact, K_eff φ, N = 10']
plot for [k = 1:3] 'theory.dat' using 1:(column(k + 1)) with lines lc rgb '#000000' lw 1.5 dt k \
  title theory[k], \
  for [k = 1:3] word('sisph sisph-N-50 sisph-R-1.2-dx', k).'-measured.dat' using 1:3 \
  with points ls 200 + k ps 1.5 title word('R=2dx,N=10 R=2dx,N=50 R=1.2dx,N=10', k), \
  for [k = 1:3] word('sisph sisph-N-50 sisph-R-1.2-dx', k).'-measured.dat' \
  using 1:($5 > 0 ? $3 : NaN) with points pt 2 ps 2 lw 2 lc rgb '#000000' \
  title (k == 1 ? 'particles went through the walls' : '')
