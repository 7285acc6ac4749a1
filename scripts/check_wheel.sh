#!/usr/bin/env bash
# Builds a wheel, installs it in a bare system of this distribution that holds nothing but Python and pip, and makes
# fields of files there, without a network, by Python and by the program raymap. Runs the Python code of README and docs
# there as it stands. Needs root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=/usr/bin/python3  # The bare system has the same.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf build/wheels
scripts/wheel.sh "$python"
scripts/bare_system.sh make "$work/system" python3-pip,python3-venv
folder=$work/system/trial
mkdir "$folder"
cp build/wheels/*.whl python/tests/{use_wheel,pages}.py "$folder"
cp --parents README.md python/README.md docs/{python,datasets}.md "$folder"
cp tests/consumer/tetrahedron.dae "$folder"
build/wheel-env/bin/python -m pip download --quiet --disable-pip-version-check --only-binary=:all: --dest "$folder" numpy

scripts/bare_system.sh run "$work/system" bash -euo pipefail -c '
  cd trial
  python3 -m venv env
  env/bin/pip install --quiet --no-index --find-links . raymap
  env/bin/python use_wheel.py
  export PYTHONUSERBASE=$PWD/user
  /usr/bin/python3 -m pip install --quiet --no-index --find-links . --user --break-system-packages raymap
  user/bin/raymap generate tetrahedron.dae -o user.vdb'
