#!/bin/sh
# Line coverage of what reads other people's bytes, by the corpora in the tree and by further folders of inputs:
#
#   cmake -B BUILD -DCMAKE_CXX_COMPILER=clang++-16 -DWEIR_FUZZERS=ON \
#     -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping"
#   cmake --build BUILD --target weir_fuzz
#   tests/fuzz/coverage.sh BUILD [FOLDER]
#
# FOLDER holds a folder for each target, as BUILD/fuzz does after run.sh. Ends with 1 if less than 85 % of the lines are
# reached. LLVM is the version's suffix of its tools.
set -eu
[ $# -ge 1 ] || { sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$1 more=${2:-}
llvm=${LLVM:--16}
rm -rf "$build/coverage"
mkdir -p "$build/coverage"
objects=
for corpus in "$here"/corpus/*; do
  target=$(basename "$corpus")
  if [ ! -x "$build/bin/weir_fuzz_$target" ]; then
    echo "left out, as it was not built: $target"
    continue
  fi
  set -- "$corpus"
  if [ -n "$more" ] && [ -d "$more/$target" ]; then set -- "$@" "$more/$target"; fi
  LLVM_PROFILE_FILE="$build/coverage/$target.profraw" "$build/bin/weir_fuzz_$target" -runs=0 -max_len=65536 \
    -detect_leaks=0 "$@" >"$build/coverage/$target.log" 2>&1 || { cat "$build/coverage/$target.log"; exit 1; }
  objects="$objects ${objects:+-object }$build/bin/weir_fuzz_$target"
done
"llvm-profdata$llvm" merge -o "$build/coverage/all.profdata" "$build"/coverage/*.profraw
# shellcheck disable=SC2086  # lists of words
"llvm-cov$llvm" export -summary-only -instr-profile "$build/coverage/all.profdata" $objects -sources \
  "$root/framework/scene" "$root/framework/geometry/ply_header.cpp" \
  "$root/nodes/particle_file" "$root/nodes/mesh_file" "$root/plugins/vtkhdf" "$root/apps/studio" \
  >"$build/coverage/summary.json"
python3 - "$build/coverage/summary.json" "$root" <<'PYTHON'
import json, sys
files = json.load(open(sys.argv[1]))["data"][0]["files"]
reached = lines = 0
for file in sorted(files, key=lambda file: file["filename"]):
    found = file["summary"]["lines"]
    reached, lines = reached + found["covered"], lines + found["count"]
    print(f'{found["percent"]:6.1f} % of {found["count"]:5}  {file["filename"].removeprefix(sys.argv[2] + "/")}')
print(f"{100 * reached / lines:6.1f} % of {lines:5}  all")
sys.exit(reached < 0.85 * lines)
PYTHON
