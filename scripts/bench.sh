#!/usr/bin/env bash
# Builds in Release and prints a table of docs/performance.md, docs/evaluation.md or another page:
#   scripts/bench.sh TABLE [ARGUMENTS]    # scripts/bench.sh --help lists the tables
# Installs the peers, and Python packages in build/python-env.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$PWD/build/bench
scripts/install.sh --bench >&2
python=$(scripts/python_env.sh --all)
[[ ${1:-} != scene ]] || "$python" -m pip install --quiet python-fcl >&2
cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF -DRAYMAP_PYTHON=ON -DPython_EXECUTABLE="$python" >&2
cmake --build "$build" >&2
RAYMAP_BENCH_BUILD=$build PYTHONPATH=$build/python exec "$python" bench/run.py "$@"
