#!/usr/bin/env bash
# Builds in Release and measures a GPU beside the CPU. Prints the tables of docs/performance.md and writes them, with
# two pictures, to out/bench_gpu:
#   scripts/bench_gpu.sh [--quick] [--device vulkan:K] [--table NAME] [--seconds S] [FOLDER of meshes]
# Work is counted, too.
# --quick uses small grids and few meshes, for a software driver. Without a folder it uses the built-in meshes.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/bench
"$root/scripts/install.sh" --bench >&2
(
  cd "$root"
  cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF
  cmake --build "$build" --target gpu_bench
) >&2
exec python3 "$root/bench/gpu_tables.py" "$build/bin/gpu_bench" "$root/out/bench_gpu" "$@"
