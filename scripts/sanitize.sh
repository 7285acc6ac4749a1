#!/usr/bin/env bash
# Builds with a sanitizer (asan: memory and undefined behaviour; tsan: data races) and runs the tests that suit it.
# Further arguments go to CMake: scripts/sanitize.sh asan -DRAYMAP_VULKAN=ON
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:?usage: scripts/sanitize.sh asan|tsan [options of CMake]}
shift
cmake --preset "$preset" "$@"
cmake --build --preset "$preset"
ctest --preset "$preset"
