#!/usr/bin/env bash
# Builds everything in Release, runs the benchmarks and prints the tables of docs/performance.md:
#   scripts/bench.sh [--rounds N] [--only TEXT]
# Installs the Python peers (libigl, Open3D, mesh2sdf) into build/bench/venv and leaves out those that do not install.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/bench_peers.sh
cmake --build "$build" >&2

echo "## Machine and stages"
echo
"$build/bin/stages_bench" --benchmark_min_time=0.2 --benchmark_format=json 2>/dev/null | python3 bench/stages_table.py
echo
echo "## Peers"
echo
"$build/venv/bin/python" bench/compare.py "$build/bin/peers" "$@"
