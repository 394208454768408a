#!/usr/bin/env bash
# The command `sphbench` itself: words, exit codes, recipes, and that nothing is run twice. Variants
# are played by a script, so that every way in which a run can end is at hand.
#
#   test_front.sh PATH/TO/sphbench
set -uo pipefail
front=$(readlink -f "${1:?the built sphbench is needed}")
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
failures=0

fail() {
  printf 'FAILED: %s\n' "$1"
  sed 's/^/    /' "$dir/out" "$dir/err" 2>/dev/null | head -n 20
  failures=$((failures + 1))
}

# expect CODE TEXT ARGUMENT...: the exit code, and a text of what is printed ('' for none)
expect() {
  local code=$1 text=$2 found
  shift 2
  "$dir/bin/sphbench" "$@" >"$dir/out" 2>"$dir/err" </dev/null
  found=$?
  ((found == code)) || fail "sphbench $*: exit code $found, not $code"
  cat "$dir/out" "$dir/err" | grep -qF -- "$text" || fail "sphbench $*: '$text' is not said"
  ((code == 0)) || (($(grep -c '^sphbench: ' "$dir/err") == 1)) ||
    fail "sphbench $*: not one sentence"
}

# --- a front end with played variants ---

mkdir -p "$dir/bin/variants"
cp "$front" "$dir/bin/sphbench"
cat >"$dir/bin/variants/sphbench-openmp-2d-f64" <<'STUB'
#!/usr/bin/env bash
calls=$(dirname "$0")/../../calls
case $1 in
  list)
    echo '[{"name": "good", "about": "runs"}, {"name": "bad", "about": "ends badly"}]' && exit ;;
  show) echo "showing $2" && exit ;;
esac
echo "$*" >>"$calls"
solver= json= output= spacing=1
while (($#)); do
  case $1 in
    --solver) solver=$2 ;;
    --json) json=$2 ;;
    --spacing) spacing=$2 ;;
    -o) output=$2 ;;
  esac
  shift
done
result() {
  : >"$output"
  cat >"$json" <<JSON
{"scene": "s", "solver": "$solver", "status": "$1", "reason": "$2", "time_end": 0.5, "particles": 3,
 "iterations": {"mean": 2, "max": 3, "total": 4}, "timing": {"per_step": 0.001},
 "metrics": {"error": {"value": $3, "unit": "1"}, "none": {"value": null, "unit": "m"}},
 "series": {"time": [0, 1, 2], "error": [1, null, 3]},
 "provenance": {"commit": "abc", "compiler": "cc <1>", "cpu": "a & b", "argv": [],
  "date": "2024-01-01T00:00:00Z", "libraries": {"hdf5": "1"}}}
JSON
}
[[ $solver == bad ]] && solver=${SOLVER_BAD:-bad}
case $solver in
  good | bad) result ok "" "$(awk "BEGIN {print $spacing ^ 2}")" ;;
  refuses) echo "sphbench: the solver cannot do <walls>" >&2 && exit 2 ;;
  diverges) result diverged "a position is not finite" 1 && exit 3 ;;
  crashes) kill -SEGV $$ ;;
  slow)
    # one tells that it was stopped, the other just ends
    trap 'kill $!; [[ $spacing == 1 ]] || exit 1; result interrupted stopped 1; exit 3' TERM INT
    sleep 20 &
    wait
    exit 1
    ;;
esac
STUB
chmod +x "$dir/bin/variants/sphbench-openmp-2d-f64"

# --- words ---

expect 0 'figure NAME' --help
expect 0 'sphbench ' --version
expect 0 'figure NAME'
expect 2 "the nearest known one is 'run'" rum
expect 2 "'sphbench --help' lists" zzzzzzzz
expect 2 "there is no folder 'no-such'" claims --results no-such
expect 2 "allowed is openmp or cuda" run scene --backend opencl
expect 2 "allowed is openmp or cuda" run scene --backend=
expect 2 "allowed is 2 or 3" run scene --dim 4
expect 2 "allowed is double or float" run scene --precision half
expect 2 "openmp-3d-f64" run scene --dim 3
expect 2 "openmp-2d-f32" run scene --precision float
expect 2 "openmp-3d-f32" speed
expect 77 "CUDA" run scene --backend cuda
expect 0 'good' list
expect 0 '"kind": "variants"' list --json
expect 0 '"name": "openmp-2d-f64"' list variants --json
expect 0 'patch-gallery' list figures
expect 0 '[' list plans --json
expect 2 'allowed is' list nothing
expect 0 'Rotating square patch' show patch-gallery
expect 0 '"kind": "figure"' show patch-gallery --json
expect 0 'showing other' show other
expect 0 'cores' doctor
expect 2 "unknown flag '--al'; the nearest known one is '--all'" figure --al
expect 2 'either NAMEs' figure
expect 2 "'patch-gallery'" figure patch-galery
expect 2 "--results needs a value" figure patch-gallery --results
expect 2 "--jobs" figure patch-gallery --jobs 0 --results "$dir/none"
expect 2 'there is no folder' report "$dir/nowhere" -o "$dir/r.html"
expect 2 '-o FILE.html is missing' report "$dir"
expect 2 'holds no results' report "$dir" -o "$dir/r.html"
expect 2 'cannot make the folder' figure patch-gallery --results /dev/null/x

# --- recipes ---

recipe() { # the text of a recipe 'mine'
  mkdir -p "$dir/mine"
  printf '%s\n' "$1" >"$dir/mine/recipe.yaml"
}
head='name: mine
about: a test
statement: nothing'
body='runs:
  - scene: s
    vary: {name: spacing, values: [1, 0.5]}
extract: {kind: metric, columns: [error], fit: true}'
mine() { expect "$1" "$2" figure "$dir/mine" --results "$dir/results" "${@:3}"; }

recipe "$head
rums: 3
$body"
mine 2 "recipe.yaml:4:1: unknown key 'rums'"
recipe "$head
runs:
  - scene: s
    solver: [good]
extract: {kind: series, columns: [error]}"
mine 2 "recipe.yaml:6:5: unknown key 'solver'"
recipe "$head
order: first
$body"
mine 2 "recipe.yaml:4:8: order is 'first'"
recipe "$head"
mine 2 "recipe.yaml:1:1: the document has no key 'extract'"
recipe ''
mine 2 "recipe.yaml is empty"
recipe "name: [mine"
mine 2 "recipe.yaml"
recipe "$head
runs: [{scene: s, solvers: [goud]}]
extract: {kind: series, columns: [error]}"
mine 2 "the nearest known name is 'good'"
recipe "$head
runs: [{scene: s}]
extract: {kind: metric, columns: [error]}"
mine 2 "recipe.yaml:4:8: kind metric needs a parameter to vary"
recipe "$head
runs: [{scene: s}]
extract: {kind: series, columns: [eror]}"
echo 'plot 1' >"$dir/mine/mine.gp"
mine 2 "the nearest known name is 'error'"
recipe "$head
runs: [{scene: s, set: [a]}]
extract: {kind: series, columns: [error]}"
mine 2 "KEY=VALUE expected"
rm -r "$dir/mine"
expect 2 "$dir/mine/recipe.yaml: No such file" figure "$dir/mine" --results "$dir/results"

# --- nothing is run twice ---

runs() { wc -l <"$dir/calls"; }
recipe "$head
$body"
cat >"$dir/mine/mine.gp" <<'GP'
width = 300; height = 200
load shared.'style.gp'
load 'contents.gp'
plot for [k = 1:n] file[k] using 1:2 with points lt colour[k] title title[k]
GP
rm -rf "$dir/results" "$dir/calls"
mine 0 '4 runs done, 0 were there already'
[[ -s $dir/results/figures/mine.svg && -s $dir/results/figures/mine.png ]] || fail 'no pictures'
(($(runs) == 4)) || fail "$(runs) runs, not 4"
grep -q "order 2.00" "$dir/results/figures/mine/contents.gp" || fail 'the order is not 2'
mine 0 '0 runs done, 4 were there already'
(($(runs) == 4)) || fail 'a second figure runs something'
files=("$dir"/results/runs/*.json)
id=$(basename "${files[0]}" .json)
rm "$dir/results/runs/$id.json"
mine 0 '1 runs done, 3 were there already'
sed -i "/$id/d" "$dir/results/journal.jsonl"
printf '{"id": "torn' >>"$dir/results/journal.jsonl"
mine 0 '1 runs done, 3 were there already'
mine 0 '0 runs done, 4 were there already'
mine 0 '' --quiet
[[ ! -s $dir/err ]] || fail '--quiet is not quiet'
printf '\n' >>"$dir/bin/variants/sphbench-openmp-2d-f64"
mine 0 '4 runs done, 0 were there already'

# --- sizes, tables, programs ---

paper='paper: sisph
place: Fig. 4'
of_paper='runs:
  - scene: s
    solvers: [good]
    spacing: 2
    set: [a=1, b=2]
    at_paper_size: {spacing: 1, set: [b=3, c=4]}'
recipe "$head
place: Fig. 4
$body"
mine 2 'paper and place belong together'
mine 2 "--size: 'big' found, allowed is desk or paper" --size big
recipe "$head
$paper
$of_paper
extract: {kind: table, columns: [error, iterations.max, status]}"
: >"$dir/calls"
mine 0 'mine.md'
grep -qF -- '--spacing 2 --set a=1 --set b=2' "$dir/calls" || fail 'not the desk size'
grep -qF 'good,4,3,ok' "$dir/results/figures/mine.csv" || fail 'the table is wrong'
grep -qF 'desk size: 3 particles' "$dir/results/figures/mine.md" || fail 'no size in the table'
grep -qF '| good | 4 | 3 | ok |' "$dir/results/figures/mine.md" || fail 'no table in Markdown'
: >"$dir/calls"
mine 0 'paper/mine.md' --size paper
grep -qF -- '--spacing 1 --set a=1 --set b=3 --set c=4' "$dir/calls" || fail 'not the paper size'
grep -qF 'paper size: 3 particles' "$dir/results/figures/paper/mine.md" || fail 'no paper size'
printf 'run,theirs [1]\ngood,7\n' >"$dir/mine/theirs.csv"
recipe "$head
$of_paper
extract: {kind: table, columns: [error], beside: {file: theirs.csv, about: theirs}}"
mine 0 mine.csv
grep -qF 'good,4,7' "$dir/results/figures/mine.csv" || fail 'not beside the paper'
printf 'run,theirs [1]\n"good, dt 1",7\n' >"$dir/mine/theirs.csv"
mine 2 "no run of the figure is called 'good, dt 1'"

cat >"$dir/bin/sphbench-analysis-played" <<'PLAYED'
#!/usr/bin/env bash
out=$1
[[ $2 == fail ]] && echo 'played: no way' >&2 && exit 1
[[ $2 == bare ]] && echo '1 2' >"$out/data.dat" && exit
[[ $2 == word ]] && echo '{"n": "many"}' >"$out/values.json" && exit
printf '# played\n# columns: x [m] | y\n1 2\n' >"$out/data.dat"
echo "{\"n\": $(($# - 3)), \"none\": null}" >"$out/values.json"
last=${*: -1}
[[ $last == good=*.json && -f ${last#good=} ]]
PLAYED
chmod +x "$dir/bin/sphbench-analysis-played"
echo "width = 300; height = 200; load shared.'style.gp'; load 'contents.gp'
plot 'data.dat' using 1:2 lt colour_good title title[1]" >"$dir/mine/mine.gp"
played() {
  recipe "$head
$of_paper
extract: {kind: program, program: $1, arguments: [$2]}"
}
played played x
mine 0 'mine.png'
grep -qF '"n": 1' "$dir/results/figures/mine/figure.json" || fail 'no values'
played absent x
mine 2 'analysis/figures/absent.c'
played played fail
mine 2 'played: no way'
played played bare
mine 2 "are not '# what it is'"
played played word
mine 2 "'n' is no number"
recipe "$head
$of_paper
extract: {kind: series, program: played, columns: [error]}"
mine 2 'kind program and the key program belong together'
rm "$dir/bin/sphbench-analysis-played"
recipe "$head
$body"
cat >"$dir/mine/mine.gp" <<'GP'
width = 300; height = 200
load shared.'style.gp'
load 'contents.gp'
plot for [k = 1:n] file[k] using 1:2 with points lt colour[k] title title[k]
GP

# --- the index, and what would be run ---

mine 0 mine.png
index=$dir/results/figures/index.html
grep -qF 'mine.png' "$index" || fail 'the index has no picture'
grep -qF '4 of 4 runs have a result' "$index" || fail 'the index has no settings'
: >"$dir/calls"
mine 0 '4 runs, 0 to do' --dry-run
rm -rf "$dir/results"
mine 0 '4 runs, 4 to do' --dry-run
[[ ! -e $dir/results/figures ]] || fail '--dry-run draws'

# --- how runs end ---

export SOLVER_BAD
for SOLVER_BAD in refuses diverges; do
  rm -rf "$dir/results"
  mine 0 '4 runs done'
  mine 0 '0 runs done'
  expect 0 report.html report "$dir/results" -o "$dir/report.html"
done
grep -q 'a position is not finite' "$dir/report.html" || fail 'the report does not say why'
SOLVER_BAD=refuses
rm -rf "$dir/results"
mine 0 '4 runs done'
expect 0 report.html report "$dir/results" -o "$dir/report.html"
grep -q 'cannot do &lt;walls&gt;' "$dir/report.html" || fail 'the report does not escape reasons'
grep -q 'cc &lt;1&gt;' "$dir/report.html" || fail 'the report does not escape facts'
grep -Eq '(src|href)="?(http|/|file)' "$dir/report.html" && fail 'the report needs other files'
SOLVER_BAD=crashes
rm -rf "$dir/results"
mine 3 'signal 11'
[[ -s $dir/results/figures/mine.png ]] || fail 'a crash keeps the figure from being drawn'

# Stopped: children end, and what was not finished is run again.
SOLVER_BAD=slow
rm -rf "$dir/results"
: >"$dir/calls"
"$dir/bin/sphbench" figure "$dir/mine" --results "$dir/results" --jobs 4 2>"$dir/err" >"$dir/out" &
pid=$!
for _ in {1..100}; do
  (($(runs) == 4)) && sleep 0.3 && break
  sleep 0.1
done
expect 2 'another sphbench is running' figure "$dir/mine" --results "$dir/results"
kill -TERM $pid
wait $pid
(($? == 3)) || fail 'stopped: exit code is not 3'
# Killed: what was finished stays, and the children do not live on.
: >"$dir/calls"
"$dir/bin/sphbench" figure "$dir/mine" --results "$dir/results" --jobs 4 2>"$dir/err" >"$dir/out" &
pid=$!
for _ in {1..100}; do
  (($(runs) == 2)) && sleep 0.3 && break
  sleep 0.1
done
kill -KILL $pid
wait $pid 2>/dev/null
for _ in {1..50}; do
  pgrep -f "$dir/bin/variants/" >/dev/null || break
  sleep 0.1
done
pgrep -f "$dir/bin/variants/" >/dev/null && fail 'killed: a child lives on'
SOLVER_BAD=
mine 0 '2 runs done, 2 were there already'
unset SOLVER_BAD

# --- the data beside the truths are those of the library ---

numbers() { tr -cd '0-9.,;\n' | tr '\n;' ',,' | tr -s ','; }
awk -F, '/^[0-9]/ {print $1}' "$source_dir/analysis/reference/data/martin_moyce_front.csv" |
  numbers >"$dir/front"
numbers <"$source_dir/analysis/reference/table_data.c" | grep -qF -- "$(cat "$dir/front")" ||
  fail 'martin_moyce_front.csv differs from table_data.c'

((failures == 0)) && echo "all passed"
exit $((failures > 0))
