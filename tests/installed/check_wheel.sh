#!/bin/sh
# Makes a wheel of a build, installs it into a fresh virtual environment of each Python, and does there what the first
# example of docs/python.md does: it must make a video.
#
# usage: check_wheel.sh BUILD SOURCE PYTHON [OTHER_PYTHON...]     PYTHON: the one that the build was made for
set -eu
build=$(cd "$1" && pwd) source=$(cd "$2" && pwd)
absolute() { printf '%s/%s' "$(cd "$(dirname "$1")" && pwd)" "$(basename "$1")"; }
python=$(absolute "$3")
shift 2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset WEIR_PLUGIN_PATH LD_LIBRARY_PATH PYTHONPATH
fail() { printf 'check: %s\n' "$*" >&2; exit 1; }

try_wheel() { # PYTHON
  "$1" --version
  rm -rf "$folder/fresh" "$folder"/*.mp4
  "$1" -m venv "$folder/fresh"
  "$folder/fresh/bin/pip" install --quiet --disable-pip-version-check "$folder"/weir-*.whl
  "$folder/fresh/bin/weir" info
  "$folder/fresh/bin/python" -c "$(cat first.py)" || fail "the first example of docs/python.md fails"
  [ "$(find . -maxdepth 1 -name '*.mp4' -size +10k | wc -l)" = 1 ] || fail "the first example made no video"
  "$folder/fresh/bin/python" -c '
import weir, pathlib
package = pathlib.Path(weir.__file__).parent
for file in weir.plugins():
    assert pathlib.Path(file).is_relative_to(package), f"{file} is not of the package"
assert len(weir.plugins()) >= 3, weir.plugins()
'
}

"$python" -B "$source/tools/packaging/make_wheel.py" "$build" "$source" "$folder"
awk '/^```python/ { inside = 1; next } /^```/ && inside { exit } inside' "$source/docs/python.md" >"$folder/first.py"
[ -s "$folder/first.py" ] || fail "docs/python.md has no example"
for each in "$@"; do
  each=$(absolute "$each")
  (cd "$folder" && try_wheel "$each")
done
"$python" -B "$source/tests/tools/elf/check_elf.py" --build "$build" "$folder"/fresh/lib/python*/site-packages/weir
echo "== The wheel is well"
