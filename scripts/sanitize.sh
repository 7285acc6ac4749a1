#!/usr/bin/env bash
# Builds with a sanitizer (asan: memory and undefined behaviour; tsan: data races) and runs the tests that suit it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:?asan or tsan}
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset"
