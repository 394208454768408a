width = 1060; height = 760
load shared.'style.gp'
load 'contents.gp'
set multiplot
inflection = 1/3.; dx = 0.4
array offset[2] = [dx, dx/2]
array about[2] = ['one kind: pressure on the neighbours j, k', \
  'two kinds: pressure on J, K half-way']
array data[2] = ['one-particle.dat', 'dual-particle.dat']
do for [p = 1:2] {
  set lmargin at screen 0.09 + 0.49*(p - 1); set rmargin at screen 0.49 + 0.49*(p - 1)
  set tmargin at screen 0.93; set bmargin at screen 0.53
  set title about[p] offset 0,-0.4
  set xlabel 'distance from a pressure point, r/R [1]'
  set ylabel (p == 1 ? "W'/max, W''/max [1]" : '')
  set xrange [-1:1]; set yrange [-1.05:1.3]
  set object 1 rect from -1,-1.05 to -inflection,1.3
  set object 2 rect from inflection,-1.05 to 1,1.3
  do for [k = 1:2] { set object k fc rgb '#f3d6d0' fillstyle solid noborder behind }
  set label 1 "unstable" at 0.66,-0.9 center textcolor rgb '#a04030'
  set label 2 "unstable" at -0.66,-0.9 center textcolor rgb '#a04030'
  set arrow 1 from -offset[p],-1.05 to -offset[p],1.3 nohead dt 2 lw 1.5
  set arrow 2 from offset[p],-1.05 to offset[p],1.3 nohead dt 2 lw 1.5
  set key top left
  plot 'kernel.dat' using 1:($3*3/8) with lines lc rgb '#0072b2' lw 2 title "W'", \
    '' using 1:($4/16) with lines lc rgb '#333333' lw 2 dt 2 title "W''"
  unset object; unset label; unset arrow
  set tmargin at screen 0.41; set bmargin at screen 0.11
  unset title
  set xlabel 'place of the particle between them [dx]'
  set ylabel (p == 1 ? "net pull R^2 [1]" : '')
  set xrange [-1:1]; set yrange [-4.2:4.2]
  set xzeroaxis lt -1 lw 0.8
  set label 1 p == 1 ? 'pulled on to the nearer one' : 'pulled back to the middle' \
    at graph 0.04, graph 0.92
  plot data[p] using 1:2 with lines lc rgb '#d55e00' lw 2.5 notitle
  unset label; unset xzeroaxis
}
unset multiplot
