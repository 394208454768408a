# The look of all figures. A script sets width and height [px] and begins with this file:
#
#   width = 800; height = 500
#   load shared.'style.gp'
#   load 'contents.gp'
#
# sphbench gives kind (svg, png), picture (the file to write) and shared (this folder), and starts
# gnuplot in the folder of the data. By hand, there:
#   gnuplot -e "kind='png'; picture='try.png'; shared='.../paper-figures/'" .../NAME.gp

# PNG at twice the size in pixels, for print and dense screens; the same layout.
if (kind eq 'svg') {
  set terminal svg size width,height font 'DejaVu Sans,14' linewidth 1 background '#ffffff'
} else {
  set terminal pngcairo size 2*width,2*height font 'DejaVu Sans,14' fontscale 2 linewidth 2 \
    pointscale 2 background '#ffffff'
}
set output picture
set encoding utf8

# Solver number k of `sphbench list solvers` has line type k: a colour, a mark and a dash of its
# own, told apart by the colour-blind as well (after Okabe and Ito); where two curves coincide, the
# thin dashed one lies on the wide one. Another form of a solver (a recipe's runs with a label) has
# the same colour, thin and dotted with an open mark: line type 20 + k; a second label's are dashed
# with a plus (40 + k), a third's dashed and dotted with a cross (60 + k).
array hue[20] = ['#0072b2', '#e69f00', '#d55e00', '#009e73', '#a6266e', '#56b4e9', \
  '#7a6a00', '#333333', '#882255', '#44aa99', '#6a51a3', '#a6761d', \
  '#e377c2', '#00494d', '#9ccb19', '#f06060', '#999999', '#3b2a8c', '#c9a400', '#5f9ea0']
array full[20] = [5, 7, 9, 11, 13, 5, 7, 9, 11, 13, 2, 3, 15, 1, 15, 2, 3, 15, 1, 3]
array open[20] = [4, 6, 8, 10, 12, 4, 6, 8, 10, 12, 2, 3, 14, 1, 14, 2, 3, 14, 1, 3]
do for [k = 1:20] {
  if (k % 3 == 1) {
    set linetype k linecolor rgb hue[k] linewidth 3.5 pointtype full[k] dashtype solid
  }
  if (k % 3 == 2) {
    set linetype k linecolor rgb hue[k] linewidth 2 pointtype full[k] dashtype (9,4)
  }
  if (k % 3 == 0) {
    set linetype k linecolor rgb hue[k] linewidth 2.2 pointtype full[k] dashtype solid
  }
  set linetype 20 + k linecolor rgb hue[k] linewidth 1.4 pointtype open[k] dashtype (2,3)
  set linetype 40 + k linecolor rgb hue[k] linewidth 1.4 pointtype 1 dashtype (7,3)
  set linetype 60 + k linecolor rgb hue[k] linewidth 1.4 pointtype 2 dashtype (7,3,2,3)
}

# What is measured or exact, not computed by a solver.
set style line 100 linecolor rgb '#000000' linewidth 1.2 pointtype 6 pointsize 1.1 dashtype solid

set border 3 linecolor rgb '#444444' linewidth 1
set tics nomirror out scale 0.6 textcolor rgb '#222222'
set grid linecolor rgb '#dddddd' linewidth 1 dashtype solid
set key noenhanced spacing 1.2 samplen 3
set pointsize 0.8
set datafile missing 'nan'

# Perceptually even from dark to light (a sampling of viridis, by S. van der Walt and N. Smith).
set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', \
  5 '#1f9e89', 6 '#35b779', 7 '#6ece58', 8 '#b5de2b', 9 '#fde725')
