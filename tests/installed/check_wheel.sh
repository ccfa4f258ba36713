#!/bin/sh
# Makes a wheel of a build, installs it into a fresh virtual environment, and does there what the first example of
# docs/python.md does: it must make a video.
#
# usage: check_wheel.sh BUILD SOURCE PYTHON
set -eu
build=$(cd "$1" && pwd) source=$(cd "$2" && pwd)
python=$(cd "$(dirname "$3")" && pwd)/$(basename "$3")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset WEIR_PLUGIN_PATH LD_LIBRARY_PATH PYTHONPATH
fail() { printf 'check: %s\n' "$*" >&2; exit 1; }

"$python" -B "$source/tools/packaging/make_wheel.py" "$build" "$source" "$folder"
"$python" -m venv "$folder/fresh"
"$folder/fresh/bin/pip" install --quiet --disable-pip-version-check "$folder"/weir-*.whl
"$python" -B "$source/tests/tools/elf/check_elf.py" --build "$build" "$folder"/fresh/lib/python*/site-packages/weir
cd "$folder"
"$folder/fresh/bin/weir" info
awk '/^```python/ { inside = 1; next } /^```/ && inside { exit } inside' "$source/docs/python.md" >first.py
[ -s first.py ] || fail "docs/python.md has no example"
"$folder/fresh/bin/python" -c "$(cat first.py)" || fail "the first example of docs/python.md fails"
[ "$(find . -maxdepth 1 -name '*.mp4' -size +10k | wc -l)" = 1 ] || fail "the first example made no video"
"$folder/fresh/bin/python" -c '
import weir, pathlib
package = pathlib.Path(weir.__file__).parent
for file in weir.plugins():
    assert pathlib.Path(file).is_relative_to(package), f"{file} is not of the package"
assert len(weir.plugins()) >= 3, weir.plugins()
'
echo "== The wheel is well"
