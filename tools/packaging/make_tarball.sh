#!/bin/sh
# Makes a relocatable tarball of a build: an installation, and below lib/weir/bundled all shared libraries that it
# needs and that a bare system may lack, with their licences in share/doc/weir/bundled, and the list of all that is from
# elsewhere in share/doc/weir/weir.spdx.json.
#
# usage: make_tarball.sh BUILD NAME OUTPUT_FOLDER
set -eu
build=$1 name=$2 output=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tree=$folder/$name

cmake --install "$build" --prefix "$tree" --strip >/dev/null
"$(dirname "$0")/bundle_libraries.sh" "$tree"
python3 -B "$(dirname "$0")/make_sbom.py" "$tree" "$(dirname "$0")/../.."

python3 "$(dirname "$0")/../../tests/tools/elf/check_elf.py" --build "$build" "$tree"

mkdir -p "$output"
tar -C "$folder" --owner=0 --group=0 --numeric-owner --sort=name -czf "$output/$name.tar.gz" "$name"
echo "$output/$name.tar.gz"
