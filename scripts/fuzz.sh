#!/usr/bin/env bash
# Runs every reader of meshes and fields on damaged files for SECONDS each (default 20), with AddressSanitizer and
# UndefinedBehaviorSanitizer. Needs clang. The corpus stays in build/fuzz/corpus.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20}

cmake -S . -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DRAYMAP_BUILD_FUZZ=ON -DRAYMAP_BUILD_APPS=OFF -DRAYMAP_BUILD_TESTS=OFF \
  -DRAYMAP_SANITIZE=address,undefined,fuzzer-no-link >/dev/null
targets=()
for seeds in fuzz/seeds/*/; do targets+=("$(basename "$seeds")_fuzz"); done
cmake --build build/fuzz --target "${targets[@]}"

for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target
  mkdir -p "$corpus"
  echo "== $target"
  "build/fuzz/bin/$target" -max_total_time="$seconds" -timeout=1 -rss_limit_mb=512 -max_len=65536 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="build/fuzz/$target-" "$corpus" "fuzz/seeds/${target%_fuzz}"
done
