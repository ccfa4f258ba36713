#!/bin/sh
# How much longer a dam break takes if every frame, 30 a simulated second, is drawn, filmed (where there is
# ffmpeg) or exported: prints a Markdown table. Runs with and without take turns, and of each kind the fastest counts.
#   output_cost.sh PROGRAM [DEVICE [SIDE [SECONDS [REPEATS]]]]     SIDE: particles along an edge of the cube
set -eu
program=$1
device=${2:-auto}
side=${3:-46}
seconds=${4:-1}
repeats=${5:-2}
scene=$(dirname "$0")/../../resources/scenes/benchmark_dam_break.json
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
spacing=$(awk "BEGIN { printf \"%.9g\", 0.81 / $side }")

# Numbers of the statistics, by their keys.
top() { tr -d '\n ' <"$folder/stats.json" | sed "s/.*\"$1\":\([-0-9.e+]*\).*/\1/"; }
of() { tr -d '\n ' <"$folder/stats.json" | sed "s/.*\"$1\":{\([^}]*\)}.*/\1/; s/.*\"$2\":\([-0-9.e+]*\).*/\1/"; }

# One run with these options. A line: wall clock from the first step on, and what the observer $1 cost.
run() {
  observer=$1
  shift
  "$program" run "$scene" --device "$device" --set "water.spacing=$spacing" --set world.frame_rate=30 \
    --duration "$seconds" --stats "$folder/stats.json" --quiet "$@" >/dev/null
  awk -v wall="$(top wall_seconds)" -v setup="$(top setup_seconds)" -v frames="$(top frames)" \
    -v capture="$(of "$observer" capture_seconds)" -v wait="$(of "$observer" wait_seconds)" \
    -v write="$(of "$observer" write_seconds)" \
    'BEGIN { n = 1000 / (frames + 1); printf "%.6f %.4g %.4g %.4g\n", wall - setup, capture * n, wait * n, write * n }'
}

parts_of_pictures() {
  echo
  echo "Parts of writing a picture (ms), in the last run with images:"
  tr -d '\n ' <"$folder/images.json" | sed 's/.*"pictures":{\([^}]*\)}.*/\1/' | tr ',' '\n' |
    awk -F'[:"]+' -v frames="$(tr -d '\n ' <"$folder/images.json" | sed 's/.*"frames":\([0-9]*\).*/\1/')" \
      '{ printf "  %s %.2f\n", $2, 1000 * $3 / (frames + 1) }'
}

for repeat in $(seq "$repeats"); do
  run statistics >>"$folder/none"
  run pictures --images "$folder/images" >>"$folder/images.txt"
  cp "$folder/stats.json" "$folder/images.json"
  if command -v ffmpeg >/dev/null; then run pictures --video "$folder/run.mp4" >>"$folder/video.txt"; fi
  run export --export "$folder/run.vtkhdf" >>"$folder/export.txt"
done
none=$(sort -g "$folder/none" | head -1 | cut -d' ' -f1)

echo "$((side * side * side)) particles on $device, $seconds s"
echo
echo "| output | time of the run (s) | loss | copying a frame (ms) | waiting, a frame (ms) | writing a frame (ms) |"
echo "|---|---:|---:|---:|---:|---:|"
printf '| none | %.3f | | | | |\n' "$none"
for kind in images video export; do
  [ -e "$folder/$kind.txt" ] || continue
  sort -g "$folder/$kind.txt" | head -1 | {
    read -r wall capture wait write
    awk -v kind="$kind" -v none="$none" -v wall="$wall" -v c="$capture" -v w="$wait" -v d="$write" \
      'BEGIN { printf "| %s | %.3f | %.1f %% | %s | %s | %s |\n", kind, wall, 100 * (wall / none - 1), c, w, d }'
  }
done
parts_of_pictures
