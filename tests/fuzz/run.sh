#!/bin/sh
# Runs each target of libFuzzer for some seconds, one after another:
#
#   tests/fuzz/run.sh BUILD SECONDS [TARGET]...
#
# What is new to a target goes into BUILD/fuzz/TARGET, what fails becomes a file in tests/fuzz/found/TARGET, which all later
# runs try first. Ends with 1 if something failed. WEIR_FUZZ_SEED makes the same inputs again; WEIR_FUZZ_JOBS runs that many
# processes of a target at a time, which share what they find.
set -eu
[ $# -ge 2 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd) seconds=$2 jobs=${WEIR_FUZZ_JOBS:-1}
shift 2
[ $# -gt 0 ] || set -- json csv ply_particles ply_mesh vtkhdf checkpoint message http websocket
failed=0
for target; do
  program=$build/bin/weir_fuzz_$target
  [ -x "$program" ] || program=$build/tests/fuzz/weir_fuzz_$target
  work=$build/fuzz/$target found=$here/found/$target
  mkdir -p "$work" "$found"
  echo "$target: $seconds s"
  set -- "$work" "$here/corpus/$target" "$found" -max_total_time="$seconds" -seed="${WEIR_FUZZ_SEED:-0}" -artifact_prefix="$found/" \
    -timeout=20 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1
  if [ "$jobs" -eq 1 ]; then
    "$program" "$@" >"$work.log" 2>&1 || failed=1
  else
    logs=$(mktemp -d)  # libFuzzer writes one for each process where it stands
    (cd "$logs" && "$program" "$@" -jobs="$jobs" -workers="$jobs" >/dev/null 2>&1) || failed=1
    cat "$logs"/*.log >"$work.log"
    rm -r "$logs"
  fi
  grep -E '^(SUMMARY|Test unit|==[0-9]+==ERROR)' "$work.log" || true
  awk '/^stat::number_of_executed_units/ { units += $2; n++ } /^stat::slowest/ && $2 > slowest { slowest = $2 }
       /^stat::peak/ && $2 > peak { peak = $2 }
       END { printf "  %d inputs in %d processes, the slowest %d s, at most %d MB\n", units, n, slowest, peak }' "$work.log"
  rmdir "$found" 2>/dev/null || true
done
rmdir "$here/found" 2>/dev/null || true
exit $failed
