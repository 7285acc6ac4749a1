#!/usr/bin/env bash
# Builds everything in Release, runs the benchmarks and prints the tables of docs/performance.md:
#   scripts/bench.sh [--rounds N] [--only TEXT]
# Installs the Python peers (libigl, Open3D, mesh2sdf) into build/bench/venv and leaves out those that do not install.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/bench
scripts/install.sh --bench >&2

cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF >&2
cmake --build "$build" >&2

if [ ! -e "$build/venv/complete" ]; then
  python3 -m venv "$build/venv" >&2
  "$build/venv/bin/pip" install --quiet numpy >&2
  for peer in libigl open3d mesh2sdf; do
    "$build/venv/bin/pip" install --quiet "$peer" >&2 || echo "$peer does not install here" >&2
  done
  touch "$build/venv/complete"
fi

echo "## Machine and stages"
echo
"$build/bin/stages_bench" --benchmark_min_time=0.2 --benchmark_format=json 2>/dev/null | python3 bench/stages_table.py
echo
echo "## Peers"
echo
"$build/venv/bin/python" bench/compare.py "$build/bin/peers" "$@"
