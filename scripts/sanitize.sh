#!/usr/bin/env bash
# Builds with a sanitizer (asan: memory and undefined behaviour; tsan: data races) and runs the tests that suit it.
# Further arguments go to CMake: scripts/sanitize.sh asan -DRAYMAP_VULKAN=ON
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:?usage: scripts/sanitize.sh asan|tsan [options of CMake]}
shift
cmake --preset "$preset" "$@"
cmake --build --preset "$preset"
if ! ctest --preset "$preset"; then
  # The tracer of LeakSanitizer may crash as a process ends: a known fault of its runtime. Failed tests run again then.
  grep 'LeakSanitizer has encountered a fatal error' "build/$preset/Testing/Temporary/LastTest.log"
  ctest --preset "$preset" --rerun-failed
fi
