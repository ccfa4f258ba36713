#!/bin/sh
# Makes a wheel of the Python package of a build, without compiling again what is compiled, and puts into it all
# shared libraries that a bare system may lack. It is for the Python that it was made with, and for systems with this
# C library or a newer one.
#
# usage: make_wheel.sh BUILD SOURCE PYTHON OUTPUT_FOLDER       PYTHON has scikit-build-core, nanobind, numpy and wheel
set -eu
tools=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd) source=$(cd "$2" && pwd) python=$3 output=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

# As it was configured, or everything would be compiled anew.
"$python" -m pip wheel "$source" --quiet --no-deps --no-build-isolation --disable-pip-version-check --wheel-dir "$folder" \
  -Cbuild-dir="$build" -Cbuild.targets=weir -Cbuild.targets=weir_python_package \
  -Ccmake.build-type="$(cached CMAKE_BUILD_TYPE)" -Ccmake.define.WEIR_CUDA="$(cached WEIR_CUDA)" \
  -Ccmake.define.WEIR_TESTS="$(cached WEIR_TESTS)" \
  -Ccmake.define.WEIR_WARNINGS_AS_ERRORS="$(cached WEIR_WARNINGS_AS_ERRORS)"
"$python" -m wheel unpack --dest "$folder/tree" "$folder"/*.whl >/dev/null
rm "$folder"/*.whl
"$tools/bundle_libraries.sh" "$folder"/tree/*/weir
"$python" -m wheel pack --dest-dir "$folder" "$folder"/tree/* >/dev/null
libc=$(ldd --version | sed -n '1s/.* \([0-9]*\)\.\([0-9]*\)$/\1_\2/p')
[ -z "$libc" ] || "$python" -m wheel tags --remove --platform-tag "manylinux_${libc}_$(uname -m)" "$folder"/*.whl >/dev/null
mkdir -p "$output"
for wheel in "$folder"/*.whl; do
  cp "$wheel" "$output/"
  echo "$output/$(basename "$wheel")"
done
