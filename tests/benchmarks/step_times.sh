#!/bin/sh
# Times a dam break at several sizes and prints a Markdown table.
#   step_times.sh PROGRAM [DEVICE [SIDES]]     SIDES: particles along an edge of the cube, "16 40 51 81 126"
set -eu
program=$1
device=${2:-auto}
sides=${3:-16 40 51 81 126}
scene=$(dirname "$0")/../../resources/scenes/benchmark_dam_break.json
stats=$(mktemp --suffix=.json)
trap 'rm -f "$stats"' EXIT

# Numbers of the statistics, by their keys.
top() { tr -d '\n ' <"$stats" | sed "s/.*\"$1\":\([-0-9.e+]*\).*/\1/"; }
step_ms() { tr -d '\n ' <"$stats" | sed "s/.*\"step_ms\":{\([^}]*\)}.*/\1/; s/.*\"$1\":\([-0-9.e+]*\).*/\1/"; }

run() {
  "$program" run "$scene" --device "$device" --set "water.spacing=$spacing" --duration "$1" \
    --stats "$stats" --quiet >/dev/null
}

echo "| particles | median step, first 0.1 s (ms) | median, 1 s (ms) | p95, 1 s (ms) | wall clock a step, 1 s (ms) | device memory (MiB) |"
echo "|---:|---:|---:|---:|---:|---:|"
for side in $sides; do
  spacing=$(awk "BEGIN { printf \"%.9g\", 0.81 / $side }")
  run 0.1
  early=$(step_ms median)
  run 1
  awk -v n=$((side * side * side)) -v early="$early" -v median="$(step_ms median)" -v p95="$(step_ms p95)" \
    -v seconds="$(top stepping_seconds)" -v steps="$(top steps)" -v bytes="$(top device_peak_bytes)" \
    'BEGIN { printf "| %d | %.3f | %.3f | %.3f | %.3f | %.0f |\n", n, early, median, p95, 1000 * seconds / steps, bytes / 1048576 }'
done
