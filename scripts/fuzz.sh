#!/usr/bin/env bash
# Runs every reader of meshes and fields on damaged files for SECONDS each (default 20), with AddressSanitizer and
# UndefinedBehaviorSanitizer. Needs clang. The corpus stays in build/fuzz/corpus.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20}

cmake --preset asan >/dev/null
targets=()
for seeds in fuzz/seeds/*/; do targets+=("$(basename "$seeds")_fuzz"); done
cmake --build --preset asan --target "${targets[@]}"

fuzz() { # target: its log appears when it ends
  local corpus=build/fuzz/corpus/$1 log=build/fuzz/$1.log status=0
  mkdir -p "$corpus"
  "build/asan/bin/$1" -max_total_time="$seconds" -timeout=300 -rss_limit_mb=512 -max_len=65536 -print_final_stats=1 \
    -verbosity=0 -artifact_prefix="build/fuzz/$1-" "$corpus" "fuzz/seeds/${1%_fuzz}" &>"$log" || status=$?
  echo "== $1" && cat "$log"
  return $status
}
export -f fuzz
export seconds
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I {} bash -euo pipefail -c 'fuzz {}'
