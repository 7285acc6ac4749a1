#!/usr/bin/env bash
# Builds in Release, measures a GPU beside the CPU, prints the tables of docs/performance.md and writes them and two
# pictures to out/bench_gpu:
#   scripts/bench_gpu.sh [--quick] [--device vulkan:K] [FOLDER of meshes]
# --quick takes small grids and few meshes, as for a driver in software. Without a folder the built-in meshes do.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/bench
scripts/install.sh --bench >&2

cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF >&2
cmake --build "$build" --target gpu_bench >&2

exec python3 bench/gpu_tables.py "$build/bin/gpu_bench" out/bench_gpu "$@"
