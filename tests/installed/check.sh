#!/bin/sh
# Installs a build, moves the installation, and checks what a user does with it: runs a scene, writes a plugin by
# `weir new-plugin`, and builds and tests it and the examples against the moved installation.
#
# usage: check.sh BUILD SOURCE [JOBS]
set -eu
build=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
jobs=${3:-$(nproc)}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# What a user's shell has set must not matter.
unset WEIR_PLUGIN_PATH LD_LIBRARY_PATH CMAKE_PREFIX_PATH

say() { printf '== %s\n' "$*"; }
fail() { printf 'check: %s\n' "$*" >&2; exit 1; }
fails_with() { # CODE TEXT COMMAND...: it must end with this code and say this
  code=$1 text=$2
  shift 2
  set +e
  "$@" >"$folder/out" 2>"$folder/err"
  found=$?
  set -e
  [ "$found" -eq "$code" ] || { cat "$folder/err" >&2; fail "'$*' ended with $found, not $code"; }
  grep -qF -- "$text" "$folder/err" || { cat "$folder/err" >&2; fail "'$*' did not say '$text'"; }
}
build_and_test() { # SOURCE [OPTION...]
  from=$1
  shift
  set -- -S "$from" -B "$from/build" -DCMAKE_PREFIX_PATH="$weir" -DWEIR_WARNINGS_AS_ERRORS=ON "$@"
  if command -v ccache >/dev/null; then
    set -- "$@" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_CUDA_COMPILER_LAUNCHER=ccache
  fi
  if command -v ninja >/dev/null; then set -- "$@" -G Ninja; fi
  cmake "$@" >"$folder/log" || { cat "$folder/log" >&2; fail "$from cannot be configured"; }
  cmake --build "$from/build" --parallel "$jobs" >"$folder/log" || { cat "$folder/log" >&2; fail "$from cannot be built"; }
  ctest --test-dir "$from/build" --output-on-failure
}

say "Installing, and moving the installation"
cmake --install "$build" --prefix "$folder/first" >"$folder/log" || { cat "$folder/log" >&2; exit 1; }
weir="$folder/some where else"
mv "$folder/first" "$weir"
"$weir/bin/weir" info
for library in framework nodes; do
  if grep -qrF -e "$build" -e "$source" "$weir/lib/cmake"; then fail "the CMake package names the build folder"; fi
  if readelf -d "$weir/lib/libweir_$library.so" | grep -F -e "$build"; then fail "libweir_$library.so names the build folder"; fi
done

say "No library comes from the current folder"
python3 "$source/tests/tools/elf/check_elf.py" --build "$build" "$weir"

if readelf -d "$weir/lib/libweir_framework.so" | grep -qF 'libcudart.so'; then
  say "All libraries take the CUDA runtime that the installation brings"
  find "$weir/bin" "$weir/lib" -type f ! -name 'libcudart*' | while read -r file; do
    readelf -d "$file" 2>/dev/null | grep -qF '[libcudart.so' || continue
    ldd "$file" | grep -F 'libcudart.so' | grep -qF "$weir/" || fail "$file takes another CUDA runtime: $(ldd "$file" | grep cudart)"
  done
fi

say "Running an installed scene, with all of its plugins"
"$weir/bin/weir" run "$weir/share/weir/scenes/dam_break.json" --set water.spacing=0.05 --frames 3 --quiet \
  --export "$folder/dam.vtkhdf" --stats "$folder/dam.json"
[ -s "$folder/dam.vtkhdf" ] || fail "there is no export"
if [ -e "$weir/lib/weir/plugins/weir_assimp.so" ]; then
  "$weir/bin/weir" run "$weir/share/weir/scenes/mesh_in_tank.json" --set mesh.file="$weir/share/weir/meshes/duck.obj" \
    --set water.spacing=0.05 --frames 1 --quiet
fi

say "Scenes by their names"
(cd "$folder" && "$weir/bin/weir" scenes | grep -x gallery/goblet >/dev/null) || fail "the installed scenes are not listed"
(cd "$folder" && "$weir/bin/weir" validate dam_break gallery/goblet)

say "A new plugin"
"$weir/bin/weir" new-plugin my_force --directory "$folder/my_force" >/dev/null
fails_with 5 "exists already" "$weir/bin/weir" new-plugin my_force --directory "$folder/my_force"
for name in "" 2fast My_Force my-force ../force class weir; do
  fails_with 2 "is not a valid name for a plugin" "$weir/bin/weir" new-plugin "$name" --directory "$folder/other"
done
fails_with 2 "there is a plugin 'vtkhdf' already" "$weir/bin/weir" new-plugin vtkhdf --directory "$folder/other"
[ ! -e "$folder/other" ] || fail "a refused plugin left files"
if grep -rniE 'my_?plugin' "$folder/my_force"; then fail "the template's name is left in the new plugin"; fi
build_and_test "$folder/my_force"
fails_with 3 "MyForcePull" "$weir/bin/weir" run "$folder/my_force/scene.json" --frames 1
WEIR_PLUGIN_PATH="$folder/my_force/build/plugins" "$weir/bin/weir" run "$folder/my_force/scene.json" --frames 1 --quiet

say "The same plugin with kernels for the baseline alone gives the same results, bit for bit"
cp -r "$folder/my_force" "$folder/baseline"
rm -r "$folder/baseline/build"
sed -i 's/^weir_add_plugin/set(WEIR_CPU_ISAS "")\nweir_add_plugin/' "$folder/baseline/CMakeLists.txt"
build_and_test "$folder/baseline" -DWEIR_CUDA=OFF
for plugin in my_force baseline; do
  "$weir/bin/weir" run "$folder/my_force/scene.json" --device cpu --frames 10 --quiet --stats "$folder/stats.json" \
    --plugin "$folder/$plugin/build/plugins/weir_my_force.so" >/dev/null
  # Sums over all particles, with every digit.
  grep -A 3 -E '"(kinetic_energy|center_of_mass|linear_momentum|bounds|max_speed)"' "$folder/stats.json" >"$folder/$plugin.txt"
done
[ -s "$folder/baseline.txt" ] || fail "there are no statistics"
cmp "$folder/my_force.txt" "$folder/baseline.txt" || fail "the instruction set changes results"

say "Plugins outlive comments and private headers, and are refused when a public header changes"
# In a copy of the installation, whose headers and digest become those of sources that are edited.
edited=$folder/edited
cp -r "$weir" "$folder/other"
inner=$folder/other/include/weir/detail
digest=$inner/framework/graph/interface_digest.h
identity() { sed -n 's/.*kInterfaceIdentity.*"\(.*\)".*/\1/p' "$digest"; }
install_edited() {
  cmake -DROOT="$edited" -DVERSION="${before%, headers *}" -DOUTPUT="$digest" -P "$source/cmake/WeirInterfaceDigest.cmake"
  (cd "$inner" && find framework nodes -type f ! -name interface_digest.h) | while read -r header; do
    cmp -s "$edited/$header" "$inner/$header" || cp "$edited/$header" "$inner/$header"
  done
}
build_against_edited() { # NAME: what comes of it
  cmake --build "$folder/edited_plugin/build" --parallel "$jobs" --target weir_my_force >"$folder/log" \
    || { cat "$folder/log" >&2; fail "my_force cannot be built"; }
  cp "$folder/edited_plugin/build/plugins/weir_my_force.so" "$folder/$1.so"
}
before=$(identity)
mkdir "$edited"
(cd "$source" && find include framework nodes -name '*.h' -o -name '*.inl' | tar -cf - -T -) | tar -C "$edited" -xf -
cp -r "$folder/baseline" "$folder/edited_plugin"
rm -r "$folder/edited_plugin/build"
cp "$folder/baseline/build/plugins/weir_my_force.so" "$folder/original.so"
cmake -S "$folder/edited_plugin" -B "$folder/edited_plugin/build" -DCMAKE_PREFIX_PATH="$folder/other" -DWEIR_CUDA=OFF >/dev/null

find "$edited" -type f -exec sed -i '1i // A comment that was not there.\n' {} +
[ ! -e "$inner/framework/graph/plugin_probe.h" ] || fail "plugin_probe.h is no private header any more"
printf 'namespace weir {\nint newInside(int);\n}\n' >>"$edited/framework/graph/plugin_probe.h"
install_edited
# This is what a host compares, so one that is built from these sources takes the original plugin.
[ "$(identity)" = "$before" ] || fail "comments, or a private header, made '$(identity)' of '$before'"
build_against_edited commented

sed -i 's/^  std::string folder; .*/&\n  int newForPlugins = 0;/' "$edited/framework/graph/place.h"
install_edited
[ "$(identity)" != "$before" ] || fail "a new member in a public header left '$before'"
build_against_edited changed

for plugin in original commented; do
  "$weir/bin/weir" run "$folder/my_force/scene.json" --device cpu --frames 1 --quiet --plugin "$folder/$plugin.so"
done
fails_with 5 "the plugin was built for Weir $(identity)" "$weir/bin/weir" nodes --plugin "$folder/changed.so"
grep -qF "Weir $before" "$folder/err" || fail "the refusal does not name this Weir's headers"

say "A plugin that writes behind its array is found by the address sanitizer"
mkdir "$folder/bounds"
cp "$source/tests/test_plugins/out_of_bounds.cpp" "$folder/bounds/"
cat >"$folder/bounds/CMakeLists.txt" <<'TEXT'
cmake_minimum_required(VERSION 3.24...3.31)
project(out_of_bounds LANGUAGES C CXX)
find_package(Weir CONFIG REQUIRED)
weir_add_plugin(out_of_bounds)
enable_testing()
TEXT
cat >"$folder/bounds/scene.json" <<'TEXT'
{ "weir": 1, "nodes": {
    "drop": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03 },
               "modules": { "solver": {"type": "SemiImplicitSolver"}, "wrong": { "type": "OutOfBounds", "before": "predict" } } } },
  "links": [ "drop.particles -> water.initial" ] }
TEXT
build_and_test "$folder/bounds" -DWEIR_CUDA=OFF -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS=-fsanitize=address
fails_with 1 "ERROR: AddressSanitizer" env LD_PRELOAD="$("${CXX:-g++}" -print-file-name=libasan.so)" \
  ASAN_OPTIONS=detect_leaks=0 "$weir/bin/weir" run "$folder/bounds/scene.json" --device cpu --frames 1 --quiet \
  --plugin "$folder/bounds/build/plugins/weir_out_of_bounds.so"
grep -q "out_of_bounds.cpp" "$folder/err" || fail "the sanitizer does not name the place"

say "The examples"
cp -r "$source/examples/plugins" "$folder/examples"
build_and_test "$folder/examples"
say "All is well"
