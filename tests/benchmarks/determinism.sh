#!/bin/sh
# Are two runs of a dam break the same bit for bit, and what does --deterministic cost? Prints a Markdown table.
# Needs h5diff. In the files two runs differ in the statistics alone, which hold times.
#   determinism.sh PROGRAM [DEVICE [SIDES [STEPS [REPEATS]]]]     SIDES: particles along an edge of the cube, as "81 284"
set -eu
program=$1
device=${2:-auto}
sides=${3:-81}
steps=${4:-1000}
repeats=${5:-3}
scene=$(dirname "$0")/../../resources/scenes/benchmark_dam_break.json
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

number() { tr -d '\n ' <"$folder/stats.json" | sed "s/.*\"$1\":\([-0-9.e+]*\).*/\1/"; }

# $steps steps, all in one frame: exports of many particles are large.
run() {
  "$program" run "$scene" --device "$device" --set "water.spacing=$spacing" --set "world.dt=$dt" \
    --set "world.frame_rate=$(awk "BEGIN { printf \"%.9g\", 1 / ($steps * $dt) }")" --duration "$(awk "BEGIN { printf \"%.9g\", $steps * $dt }")" --stats "$folder/stats.json" --quiet "$@" >/dev/null
}

# Milliseconds a step, of the quickest run so far ($1) and one more.
time_step() {
  least=$1
  shift
  run "$@"
  awk -v least="$least" -v wall="$(number wall_seconds)" -v setup="$(number setup_seconds)" -v steps="$steps" \
    'BEGIN { t = 1000 * (wall - setup) / steps; printf "%.4f", t < least ? t : least }'
}

echo "| particles | steps | two runs | ms a step | with --deterministic | cost |"
echo "|---:|---:|---|---:|---:|---:|"
for side in $sides; do
  spacing=$(awk "BEGIN { printf \"%.9g\", 0.81 / $side }")
  # 1 ms at 81 particles along an edge. In proportion to the spacing, so that the fluid is compressed as much by three
  # iterations whatever its resolution.
  dt=$(awk "BEGIN { printf \"%.9g\", 0.081 / $side }")
  for k in 1 2; do run --export "$folder/$k.vtkhdf"; done
  if h5diff "$folder/1.vtkhdf" "$folder/2.vtkhdf" /VTKHDF /VTKHDF >"$folder/differences"; then
    same="the same bits"
  else
    same="differ"
  fi
  rm -f "$folder"/*.vtkhdf
  without=1e9 with=1e9
  for repeat in $(seq "$repeats"); do
    without=$(time_step "$without")
    with=$(time_step "$with" --deterministic)
  done
  awk -v n=$((side * side * side)) -v steps="$steps" -v same="$same" -v a="$without" -v b="$with" \
    'BEGIN { printf "| %d | %d | %s | %.3f | %.3f | %+.1f %% |\n", n, steps, same, a, b, 100 * (b / a - 1) }'
done
