# Error of the solution against CPU seconds and ray equivalents, from benches of tests/bench/solver.yaml in four folders:
#   gnuplot -e "folder='out/bench_solver'; rates='9.4 9.4 9.4 3.8'" tests/bench/plots/solver.gnuplot
# `rates`: million rays a second of raw Embree in each, measured in the same hour (solver_bench).
scenes = "cornell_5k cornell_20k cornell_100k gallery"
titles = "'Cornell box, 5,294 patches' 'Cornell box, 21,989' 'Cornell box, 109,808' 'gallery, 17,413'"
lows = "0.03 0.1 0.4 0.4"
highs = "10 40 200 400"
set terminal pngcairo size 1200,860 font "sans,11"
set output "solver.png"
set datafile separator ","
set logscale xyx2
set grid xtics ytics lc rgb "#cccccc" lw 1
set key right top
set format y "%g%%"
set yrange [0.1:100]
set multiplot layout 2,2 spacing 0.07,0.16 margins 0.06,0.98,0.07,0.92
do for [k=1:4] {
  file = folder."/".word(scenes, k)."/bench/bench.csv"
  rate = real(word(rates, k))
  unset label
  set label word(titles, k) at graph 0.03,0.06 font "sans,13"
  set xlabel "CPU seconds of the solve"
  set x2label "million ray equivalents" offset 0,-0.6
  set xtics nomirror
  set x2tics
  low = real(word(lows, k)); high = real(word(highs, k))
  set xrange [low:high]
  set x2range [low * rate:high * rate]
  of(factors, method) = sprintf("<awk -F, '!/^variant/{gsub(/\"[^\"]*\"/,\"v\")} /^v/ && $3==\"%s\" && $4==\"%s\" && $NF!=\"\" && $24!=\"\"{print $9\",\"100*$24}' %s", factors, method, file)
  plot of("rays", "matrix") using 1:2 with linespoints lw 2 pt 7 lc rgb "#0060ad" title "matrix, rays", \
       of("rays", "progressive") using 1:2 with linespoints lw 2 pt 5 lc rgb "#dd181f" title "progressive, rays", \
       of("hemicube", "matrix") using 1:2 with linespoints lw 2 pt 9 lc rgb "#2ca02c" title "matrix, hemicube", \
       of("hemicube", "progressive") using 1:2 with linespoints lw 2 pt 11 lc rgb "#9467bd" title "progressive, hemicube"
}
unset multiplot
