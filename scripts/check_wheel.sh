#!/usr/bin/env bash
# Builds a wheel, installs it in a bare system of this distribution that holds nothing but Python and pip, and makes fields
# of files there, without a network. Runs the Python code of README and docs there as it stands. Needs root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=/usr/bin/python3  # The bare system has the same.
type -P debootstrap >/dev/null || apt-get install -y -q debootstrap </dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf build/wheels
scripts/wheel.sh "$python"
debootstrap --variant=minbase --include=python3-pip,python3-venv "$(. /etc/os-release && echo "$VERSION_CODENAME")" \
  "$work/system" >"$work/debootstrap.log" || { tail -n 20 "$work/debootstrap.log" && exit 1; }
folder=$work/system/trial
mkdir "$folder"
cp build/wheels/*.whl python/tests/{use_wheel,pages}.py "$folder"
cp --parents README.md python/README.md docs/{python,datasets}.md "$folder"
cp tests/consumer/tetrahedron.dae "$folder"
build/wheel-env/bin/python -m pip download --quiet --disable-pip-version-check --only-binary=:all: --dest "$folder" numpy

# /proc vanishes with the namespace.
unshare --mount bash -euo pipefail -c "
  mount -t proc proc '$work/system/proc'
  chroot '$work/system' env -i PATH=/usr/bin:/bin bash -euo pipefail -c '
    cd trial
    python3 -m venv env
    env/bin/pip install --quiet --no-index --find-links . raymap
    env/bin/python use_wheel.py'"
