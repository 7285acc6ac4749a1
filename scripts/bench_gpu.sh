#!/usr/bin/env bash
# Builds in Release, measures a GPU beside the CPU, prints the tables of docs/performance.md and writes them and two
# pictures to out/bench_gpu:
#   scripts/bench_gpu.sh [--quick] [--device vulkan:K] [FOLDER of meshes]
# --quick takes small grids and few meshes, as for a driver in software. Without a folder the built-in meshes do.
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
