# Curves of one solver that differ in a parameter: line styles 201 .. 208, from dark to light, each
# with a dash of its own where two lie on each other. Loaded after style.gp.
array shade[8] = ['#440154', '#31688e', '#35b779', '#e0a100', '#d55e00', '#a6266e', \
  '#777777', '#000000']
array stroke[8] = [1, 2, 4, 5, 1, 2, 4, 5]
do for [k = 1:8] {
  set style line 200 + k linecolor rgb shade[k] linewidth 2.2 dashtype stroke[k] \
    pointtype 4 + 2*(k % 5)
}
