#!/usr/bin/env bash
# Installs a wheel in a bare system that holds nothing but Python and pip, and makes fields of files there, without a
# network, by Python and by the program raymap. Runs the code of README and docs there as it stands, and says how long it
# takes to the first picture. Needs root.
#
# scripts/check_wheel.sh [WHEEL [DISTRIBUTION]]: builds one if none is given, and its bill of materials. Another distribution,
# such as forky, has another Python.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [[ $# -eq 0 ]]; then
  rm -rf build/wheels
  scripts/wheel.sh /usr/bin/python3  # The bare system has the same.
  set -- build/wheels/*.whl
  SOURCE_DATE_EPOCH=0 scripts/sbom.py "$(ls -td build/wheel-cp* | head -n 1)" "$1" build/raymap.cdx.json
fi
scripts/bare_system.sh make "$work/system" python3-pip,python3-venv "${@:2}"
version=$(scripts/bare_system.sh run "$work/system" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
folder=$work/system/trial
mkdir "$folder"
cp "$1" python/tests/{use_wheel,pages}.py "$folder"
cp --parents README.md python/README.md docs/{python,datasets}.md "$folder"
cp tests/consumer/tetrahedron.dae "$folder"
build/wheel-env/bin/python -m pip download --quiet --disable-pip-version-check --only-binary=:all: --dest "$folder" \
  --python-version "$version" numpy
echo "Python $version"

scripts/bare_system.sh run "$work/system" bash -euo pipefail -c '
  cd trial
  python3 -m venv env
  TIMEFORMAT="%R s from pip install, NumPy with it, to the first picture"
  time {
    env/bin/pip install --quiet --no-index --find-links . raymap
    env/bin/raymap -q example -o first.ply
    env/bin/raymap -q render first.ply -o first.png
  }
  env/bin/python use_wheel.py
  export PYTHONUSERBASE=$PWD/user
  /usr/bin/python3 -m pip install --quiet --no-index --find-links . --user --break-system-packages raymap
  user/bin/raymap generate tetrahedron.dae -o user.vdb'
scripts/bare_system.sh readme "$work/system" /trial/env/bin
