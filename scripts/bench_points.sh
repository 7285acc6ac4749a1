#!/usr/bin/env bash
# Builds in Release, runs `Surface` and its peers on the same points and prints the tables of docs/performance.md:
#   scripts/bench_points.sh [--rounds N] [--count POINTS] [--only TEXT]
# Installs the Python peers (libigl, Open3D) into build/bench/venv and leaves out those that do not install.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/bench_peers.sh
cmake --build "$build" --target point_peers >&2
"$build/venv/bin/python" bench/points.py "$build/bin/point_peers" "$@"
