#!/bin/sh
# Times late flow of the dam break on the CPU with each set of instructions, and prints a Markdown table.
#   cpu_steps.sh PROGRAM [SIDE [THREADS [REPEATS]]]     SIDE: particles along an edge of the cube
# CPU time a step is that of all threads, less that of setting the run up; it bears other load on the machine better than the
# clock does. The runs of one repeat follow one another, so that compared ones meet the same load.
set -eu
program=$1
side=${2:-51}
threads=${3:-4}
repeats=${4:-2}
dam_break=$(dirname "$0")/../../resources/scenes/benchmark_dam_break.json
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
spacing=$(awk "BEGIN { printf \"%.9g\", 0.81 / $side }")

sed 's|"block": {.*|"block": { "type": "ParticleFile", "params": { "file": "late.vtkhdf" } },|' "$dam_break" >"$work/late.json"
"$program" run "$dam_break" --device cpu --set "water.spacing=$spacing" --set world.frame_rate=2 --duration 0.5 \
  --quiet --export "$work/state.vtkhdf" >/dev/null
mv "$work/state.vtkhdf" "$work/late.vtkhdf"

# run ISA DURATION: prints CPU seconds
run() {
  LC_ALL=C WEIR_CPU_ISA=$1 bash -c 'TIMEFORMAT="%U %S"; time "$@" 2>/dev/null >/dev/null' - "$program" run "$work/late.json" \
    --device cpu --threads "$threads" --set "water.spacing=$spacing" --set world.frame_rate=25 --duration "$2" --quiet \
    --stats "$work/stats.json" 2>&1 | awk '{ print $1 + $2 }'
}
number() { tr -d '\n ' <"$work/stats.json" | sed "s|.*\"$1\":{\([^}]*\)}.*|\1|; s|.*\"$2\":\([-0-9.e+]*\).*|\1|"; }
# share MODULE: its milliseconds a step
share() { number "water/$1" per_step; }

echo "| instructions | CPU time a step (ms) | median step (ms) | sort | list | solver | viscosity | boundary |"
echo "|---|---:|---:|---:|---:|---:|---:|---:|"
for repeat in $(seq "$repeats"); do
  for isa in baseline avx2 avx512; do
    setup=$(run "$isa" 0.001) || continue
    all=$(run "$isa" 0.081)
    awk -v isa="$isa" -v cpu="$(awk "BEGIN { print ($all - $setup) / 80 }")" -v median="$(number step_ms median)" \
      -v a="$(share neighbors/sort)" -v b="$(share neighbors/list)" -v c="$(share solver)" -v d="$(share viscosity)" \
      -v e="$(share boundary)" \
      'BEGIN { printf "| %s | %.1f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", isa, 1000 * cpu, median, a, b, c, d, e }'
  done
done
