# Three families of curves (strategies, spacings of virtual particles, time steps), both forms.
width = 1320; height = 720
load shared.'style.gp'
load shared.'shades.gp'
load 'contents.gp'
set multiplot layout 2,3 margins 0.075,0.985,0.128,0.95 spacing 0.05,0.17
array first[3] = [1, 4, 7]
array last[3] = [3, 6, 9]
array about[3] = ['strategies', 'spacing of virtual particles', 'time step']
set xlabel label_x
set logscale y
set format y '10^{%L}'
do for [form = 2:3] {
  do for [p = 1:3] {
    set title about[p] offset 0,-0.6
    set ylabel (p > 1 ? '' : form == 2 ? 'Γ as printed [mixed]' : 'Γ, dimensionless [1]')
    set key bottom right font ',12'
    if (p == 1) {
      plot for [k = 1:3] file[k] using 1:(column(form)) with lines lt colour[k] title title[k]
    } else {
      low = first[p]
      high = last[p]
      plot file[3] using 1:(column(form)) with lines ls 208 title title[3].', dx, 1 ms', \
        for [k = low:high] file[k] using 1:(column(form)) with lines ls 201 + k - low \
        title title[k]
    }
  }
}
unset multiplot
