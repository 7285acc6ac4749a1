#!/usr/bin/env bash
# Prints the Python of a virtual environment, build/python-env, that can build and test the Python package. Makes it, and
# installs from PyPI what python/tests/requirements.txt names; with --all also large_packages.txt, 8 GB, which tests of
# their meshes and arrays need; with --site site_packages.txt, which build the documentation site.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
env=build/python-env

install() { # the list of packages, unless it is installed already
  if cmp -s "python/tests/$1" "$env/$1"; then return; fi
  echo "Installing the packages of python/tests/$1" >&2
  # pysdf is built here, and looks for Eigen among the system headers.
  CPLUS_INCLUDE_PATH=/usr/include/eigen3 "$env/bin/python" -m pip install --quiet --no-compile --disable-pip-version-check -r "python/tests/$1" >&2
  cp "python/tests/$1" "$env/$1"
}

if [[ ! -x $env/bin/python ]]; then python3 -m venv "$env" >&2; fi
install requirements.txt
if [[ ${1:-} == --all ]]; then install large_packages.txt; fi
if [[ ${1:-} == --site ]]; then install site_packages.txt; fi
echo "$PWD/$env/bin/python"
