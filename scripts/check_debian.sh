#!/usr/bin/env bash
# Installs the packages that scripts/debian_package.sh has built in bare systems of this distribution, without a network.
# Runs README's lines for the shell in one, and builds its lines for C++ in the other. Needs root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The names of a package's dependencies, but for that on the other package.
dependencies() { dpkg-deb -f build/debian/"$1"_*.deb Depends | sed 's/ *([^)]*)//g; s/ *|[^,]*//g; s/, /\n/g' | grep -vx raymap | paste -sd,; }

make_system() { # folder, packages of ours, packages of the distribution
  local package needed=$3
  for package in $2; do needed+=,$(dependencies "$package"); done
  scripts/bare_system.sh make "$1" "${needed#,}"
  for package in $2; do cp build/debian/"$package"_*.deb "$1"; done
  scripts/bare_system.sh run "$1" env PATH=/usr/sbin:/usr/bin:/sbin:/bin bash -c 'dpkg -i /*.deb'
}

make_system "$work/program" raymap ""
scripts/bare_system.sh readme "$work/program" /usr/bin
make_system "$work/library" "raymap libraymap-dev" g++,pkg-config
cp tests/consumer/{app.cpp,tetrahedron.dae} README.md "$work/library"
scripts/bare_system.sh run "$work/library" bash -euo pipefail -c '
  eval "$(sed -n "/^c++ /p" README.md)"
  ./app'
