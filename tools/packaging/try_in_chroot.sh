#!/bin/sh
# Unpacks a tarball in bare systems, each made by debootstrap with nothing but its base packages, and runs the demo
# scene there without installing anything and without a network. Needs root, debootstrap and a network; the bare
# systems are kept in a folder for the next time, and what is tried happens in copies of them.
#
# usage: try_in_chroot.sh TARBALL [SYSTEM...]        SYSTEM: bookworm, trixie, noble, the default, or jammy, sid
# WEIR_CHROOTS: the folder for the systems, /var/tmp/weir-chroots by default
# WEIR_TRY_MORE=1: then install ffmpeg, Mesa and a compiler there, make a video, so that drivers of that system meet
#                  the bundled libraries, and build, test and run a new plugin
# WEIR_WHEEL=FILE: then install Python and this wheel there, and make the video of the first example of docs/python.md;
#                  for systems with the Python that the wheel is for
# WEIR_DEB=FILE: then install this package there, and make a video; for the system that it was built on
set -eu
tarball=$1
shift
[ $# -gt 0 ] || set -- bookworm trixie noble
source=$(cd "$(dirname "$0")/../.." && pwd)
folder=${WEIR_CHROOTS:-/var/tmp/weir-chroots}
name=$(basename "$tarball" .tar.gz)

make_system() {
  case "$1" in
    jammy | noble)
      # debootstrap of Debian may not know Ubuntu's newer names and keys; its script for all of them is gutsy.
      set -- --components=main,universe --no-check-gpg "$1" "$folder/$1" http://archive.ubuntu.com/ubuntu \
        /usr/share/debootstrap/scripts/gutsy ;;
    *) set -- "$1" "$folder/$1" http://deb.debian.org/debian ;;
  esac
  debootstrap --variant=minbase "$@" >"$folder/log" 2>&1 || { tail "$folder/log" >&2; exit 1; }
}

# In a network namespace of its own, which has no network.
offline() { unshare --net chroot "$system" env -i PATH=/usr/bin:/bin weir="/opt/weir/$name" sh -eu -c "$1"; }
online() {
  cp /etc/resolv.conf "$system/etc/resolv.conf"
  chroot "$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive weir="/opt/weir/$name" \
    sh -eu -c 'install() {
      apt-get update -q >/tmp/log && apt-get install -y -q --no-install-recommends "$@" >/tmp/log 2>&1 || { tail -n 20 /tmp/log >&2; exit 1; }
    }
    '"$1"
}

try_bare() {
  offline '
    . /etc/os-release
    echo "== $PRETTY_NAME, $(dpkg-query -W | wc -l) packages, no network"
    cd /tmp
    "$weir/bin/weir" info | sed -n "/^Plugins/,/^ *searched/p"
    "$weir/bin/weir" run "$weir/share/weir/scenes/jet_fills_goblet.json" --frames 3 --quiet \
      --stats stats.json --export goblet.vtkhdf
    ls -l stats.json goblet.vtkhdf
    "$weir/bin/weir" new-plugin my_force --directory my_force >/dev/null && rm -r my_force
    # Pictures need what a bare system has not: this must be said, and nothing else go wrong.
    if "$weir/bin/weir" run "$weir/share/weir/scenes/jet_fills_goblet.json" --frames 1 --quiet --video out.mp4; then
      echo "there is a video"
    else
      echo "no video, as said above"
    fi
  '
}

try_more() {
  online '
    echo "== The same with ffmpeg, Mesa and a compiler"
    install ffmpeg libegl1 libgl1-mesa-dri g++ cmake make'
  offline '
    cd /tmp
    "$weir/bin/weir" run "$weir/share/weir/scenes/jet_fills_goblet.json" --frames 2 --quiet --video out.mp4
    ls -l out.mp4
    "$weir/bin/weir" new-plugin my_force >/dev/null
    cmake -S my_force -B my_force/build -DCMAKE_PREFIX_PATH="$weir" >/dev/null
    cmake --build my_force/build >/dev/null
    ctest --test-dir my_force/build
    "$weir/bin/weir" run my_force/scene.json --plugin my_force/build/plugins/weir_my_force.so --frames 2 --quiet --video force.mp4
    ls -l force.mp4
  '
}

try_wheel() {
  cp "$WEIR_WHEEL" "$system/tmp/"
  awk '/^```python/ { inside = 1; next } /^```/ && inside { exit } inside' "$source/docs/python.md" >"$system/tmp/first.py"
  online '
    echo "== The wheel"
    install ffmpeg libegl1 libgl1-mesa-dri python3-venv
    cd /tmp
    python3 -m venv fresh
    fresh/bin/pip install --quiet --disable-pip-version-check weir-*.whl'
  offline '
    cd /tmp
    fresh/bin/python first.py
    ls -l dam.mp4'
}

try_deb() {
  cp "$WEIR_DEB" "$system/tmp/"
  online '
    echo "== The .deb"
    install /tmp/weir_*.deb ffmpeg libegl1 libgl1-mesa-dri
    dpkg-query -W weir'
  offline '
    cd /tmp
    weir run /usr/share/weir/scenes/jet_fills_goblet.json --frames 2 --quiet --video deb.mp4
    ls -l deb.mp4'
}

# In a fresh copy of the system `bare`.
try_in_copy() {
  system=$folder/$bare.try
  rm -rf "$system"
  cp -a --reflink=auto "$folder/$bare" "$system"
  mkdir -p "$system/opt/weir"
  if [ "$1" != try_wheel ] && [ "$1" != try_deb ]; then tar -C "$system/opt/weir" -xzf "$tarball"; fi
  mount -t proc proc "$system/proc"
  set +e
  (set -e; for part in "$@"; do "$part"; done)
  code=$?
  set -e
  umount "$system/proc"
  rm -rf "$system"
  [ "$code" -eq 0 ] || { echo "try_in_chroot: $bare: FAILED ($code)" >&2; exit 1; }
}

mkdir -p "$folder"
for bare in "$@"; do
  if [ ! -e "$folder/$bare/etc/os-release" ]; then make_system "$bare"; fi
  if [ -n "${WEIR_TRY_MORE:-}" ]; then try_in_copy try_bare try_more; else try_in_copy try_bare; fi
  if [ -n "${WEIR_WHEEL:-}" ]; then try_in_copy try_wheel; fi
  if [ -n "${WEIR_DEB:-}" ]; then try_in_copy try_deb; fi
done
