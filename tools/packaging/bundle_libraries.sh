#!/bin/sh
# Copies all shared libraries that an installation needs and that a bare system may lack into its lib/weir/bundled,
# and their licences into share/doc/weir/bundled. The plugin of MPI is taken out.
#
# usage: bundle_libraries.sh PREFIX
set -eu
tree=$1
bundled=$tree/lib/weir/bundled
licences=$tree/share/doc/weir/bundled

# Libraries of the system, which must not come from another one:
#   those of the C library, which belong to its loader;
#   the C++ library, as drivers of OpenGL that are loaded later may need a newer one than a bundled one would be;
#   OpenGL and CUDA, which belong to the drivers.
is_of_system() {
  case "$1" in
    linux-vdso.so.* | ld-linux*.so.* | libc.so.* | libm.so.* | libdl.so.* | libpthread.so.* | librt.so.* | \
      libresolv.so.* | libutil.so.* | libnsl.so.* | libmvec.so.* | libanl.so.*) return 0 ;;
    libstdc++.so.* | libgcc_s.so.*) return 0 ;;
    libGL*.so.* | libEGL*.so.* | libOpenGL.so.* | libOSMesa.so.* | libcuda.so.* | libnvidia-*) return 0 ;;
    libweir_*) return 0 ;;
  esac
  return 1
}

copy_licence() { # of the Debian package that a library belongs to
  command -v dpkg-query >/dev/null || return 0
  # Folders below / are links to those below /usr, and packages name either.
  package=$(dpkg-query -S "$1" "${1#/usr}" "/usr$1" 2>/dev/null | head -n 1 | cut -d: -f1)
  [ -n "$package" ] || return 0
  cp "/usr/share/doc/$package/copyright" "$licences/$package.txt" 2>/dev/null || true
}

mkdir -p "$bundled" "$licences"
# An MPI works with the launcher of its own cluster only, so what needs it is built there.
rm -f "$tree/lib/weir/plugins/weir_mpi.so"
# ldd names what those libraries need in turn, too.
find "$tree" -type f \( -name '*.so' -o -perm -u+x \) | while read -r file; do
  ldd "$file" | while read -r library arrow path rest; do
    [ "$arrow" = "=>" ] || continue
    if is_of_system "$library"; then continue; fi
    case "$path" in "$tree"/*) continue ;; esac
    [ -f "$path" ] || { echo "make_tarball: $file needs $library, which is not there" >&2; exit 1; }
    [ -e "$bundled/$library" ] && continue
    real=$(readlink -f "$path")
    cp "$real" "$bundled/$library"
    chmod 644 "$bundled/$library"
    copy_licence "$real"
  done
done
