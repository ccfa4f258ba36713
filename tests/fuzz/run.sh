#!/bin/sh
# Runs each target of libFuzzer for some seconds, one after another:
#
#   tests/fuzz/run.sh BUILD SECONDS [TARGET]...
#
# What is new to a target goes into BUILD/fuzz/TARGET, what fails becomes a file in tests/fuzz/found/TARGET, which all later
# runs try first. Ends with 1 if something failed. WEIR_FUZZ_SEED makes the same inputs again.
set -eu
[ $# -ge 2 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
build=$1 seconds=$2
shift 2
[ $# -gt 0 ] || set -- json csv ply_particles ply_mesh vtkhdf checkpoint message http websocket
failed=0
for target; do
  program=$build/bin/weir_fuzz_$target
  [ -x "$program" ] || program=$build/tests/fuzz/weir_fuzz_$target
  work=$build/fuzz/$target found=$here/found/$target
  mkdir -p "$work" "$found"
  echo "$target: $seconds s"
  "$program" "$work" "$here/corpus/$target" "$found" -max_total_time="$seconds" -seed="${WEIR_FUZZ_SEED:-0}" -artifact_prefix="$found/" -timeout=20 \
    -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 >"$work.log" 2>&1 || failed=1
  grep -E '^(stat::(number_of_executed_units|new_units_added|slowest|peak)|SUMMARY|Test unit|==[0-9]+==ERROR)' "$work.log" || true
  rmdir "$found" 2>/dev/null || true
done
rmdir "$here/found" 2>/dev/null || true
exit $failed
