#!/bin/sh
# Unpacks a tarball in bare systems, each made by debootstrap with nothing but its base packages, and runs the demo
# scene there without installing anything. Needs root, debootstrap and a network; systems are kept in a folder for
# the next time.
#
# usage: try_in_chroot.sh TARBALL [SYSTEM...]        SYSTEM: bookworm, trixie, noble (all of them by default)
# WEIR_CHROOTS: the folder for the systems, /var/tmp/weir-chroots by default
# WEIR_TRY_MORE=1: then install ffmpeg, Mesa and a compiler there, make a video, so that drivers of that system meet
#                  the bundled libraries, and build and test a new plugin
set -eu
tarball=$1
shift
[ $# -gt 0 ] || set -- bookworm trixie noble
folder=${WEIR_CHROOTS:-/var/tmp/weir-chroots}
name=$(basename "$tarball" .tar.gz)

make_system() {
  case "$1" in
    noble)
      # debootstrap of Debian may not know Ubuntu's newer names and keys; its script for all of them is gutsy.
      set -- --components=main --no-check-gpg noble "$folder/$1" http://archive.ubuntu.com/ubuntu \
        /usr/share/debootstrap/scripts/gutsy ;;
    *) set -- "$1" "$folder/$1" http://deb.debian.org/debian ;;
  esac
  debootstrap --variant=minbase "$@" >"$folder/log" 2>&1 || { tail "$folder/log" >&2; exit 1; }
}

try() {
  system=$folder/$1
  if [ ! -e "$system/etc/os-release" ]; then make_system "$1"; fi
  rm -rf "$system/opt/weir"
  mkdir -p "$system/opt/weir"
  tar -C "$system/opt/weir" -xzf "$tarball"
  mount -t proc proc "$system/proc"
  set +e
  chroot "$system" env -i PATH=/usr/bin:/bin sh -eu -c '
    . /etc/os-release
    echo "== $PRETTY_NAME"
    weir=/opt/weir/'"$name"'
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
  code=$?
  if [ "$code" -eq 0 ] && [ -n "${WEIR_TRY_MORE:-}" ]; then
    cp /etc/resolv.conf "$system/etc/resolv.conf"
    chroot "$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive sh -eu -c '
      if grep -q ubuntu /etc/apt/sources.list; then sed -i "s/ main$/ main universe/" /etc/apt/sources.list; fi
      apt-get update -q >/dev/null
      apt-get install -y -q --no-install-recommends ffmpeg libegl1 libgl1-mesa-dri g++ cmake make \
        >/dev/null 2>&1
      weir=/opt/weir/'"$name"'
      "$weir/bin/weir" run "$weir/share/weir/scenes/jet_fills_goblet.json" --frames 2 --quiet --video /tmp/out.mp4
      ls -l /tmp/out.mp4
      rm -rf /tmp/my_force
      "$weir/bin/weir" new-plugin my_force --directory /tmp/my_force >/dev/null
      cmake -S /tmp/my_force -B /tmp/my_force/build -DCMAKE_PREFIX_PATH="$weir" >/dev/null
      cmake --build /tmp/my_force/build >/dev/null
      ctest --test-dir /tmp/my_force/build
    '
    code=$?
  fi
  set -e
  umount "$system/proc"
  [ "$code" -eq 0 ] || { echo "try_in_chroot: $1: FAILED ($code)" >&2; exit 1; }
}

mkdir -p "$folder"
for one in "$@"; do try "$one"; done
