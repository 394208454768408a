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
  set terminal svg size width,height dynamic font 'DejaVu Sans,14' linewidth 1 background '#ffffff'
} else {
  set terminal pngcairo size 2*width,2*height font 'DejaVu Sans,14' fontscale 2 linewidth 2 \
    pointscale 2 background '#ffffff'
}
set output picture
set encoding utf8

# Solver number k of `sphbench list solvers` has line type k: a colour, a mark and a dash of its own,
# told apart by the colour-blind as well (the first eight: Okabe and Ito).
set linetype 1 linecolor rgb '#0072b2' linewidth 2 pointtype 5 pointsize 0.9 dashtype solid
set linetype 2 linecolor rgb '#e69f00' linewidth 2 pointtype 7 pointsize 0.9 dashtype (12,4)
set linetype 3 linecolor rgb '#d55e00' linewidth 2 pointtype 9 pointsize 1.0 dashtype solid
set linetype 4 linecolor rgb '#009e73' linewidth 2 pointtype 11 pointsize 1.0 dashtype (8,4,2,4)
set linetype 5 linecolor rgb '#cc79a7' linewidth 2 pointtype 13 pointsize 1.1 dashtype (4,3)
set linetype 6 linecolor rgb '#56b4e9' linewidth 2 pointtype 4 pointsize 0.9 dashtype solid
set linetype 7 linecolor rgb '#7a6a00' linewidth 2 pointtype 6 pointsize 0.9 dashtype (12,4)
set linetype 8 linecolor rgb '#333333' linewidth 2 pointtype 8 pointsize 1.0 dashtype (8,4,2,4)
set linetype 9 linecolor rgb '#882255' linewidth 2 pointtype 10 pointsize 1.0 dashtype (4,3)
set linetype 10 linecolor rgb '#44aa99' linewidth 2 pointtype 12 pointsize 1.1 dashtype solid
set linetype 11 linecolor rgb '#6a51a3' linewidth 2 pointtype 2 pointsize 0.9 dashtype (12,4)
set linetype 12 linecolor rgb '#a6761d' linewidth 2 pointtype 3 pointsize 0.9 dashtype (8,4,2,4)
set linetype cycle 12

# What is measured or exact, not computed by a solver.
set style line 100 linecolor rgb '#000000' linewidth 1.2 pointtype 6 pointsize 1.1 dashtype solid

set border 3 linecolor rgb '#444444' linewidth 1
set tics nomirror out scale 0.6 textcolor rgb '#222222'
set grid linecolor rgb '#e3e3e3' linewidth 0.7 dashtype solid
set key noenhanced spacing 1.2 samplen 3
set datafile missing 'nan'

# Perceptually even from dark to light (a sampling of viridis, by S. van der Walt and N. Smith).
set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', \
  5 '#1f9e89', 6 '#35b779', 7 '#6ece58', 8 '#b5de2b', 9 '#fde725')
