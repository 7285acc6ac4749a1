#!/usr/bin/env bash
# Runs clang-tidy on our own sources in parallel. Arguments choose files: scripts/tidy.sh apps/main.cpp
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset release >/dev/null
files=("$@")
if [[ ${#files[@]} -eq 0 ]]; then mapfile -t files < <(git ls-files 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp'); fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/release --quiet --extra-arg=-Wno-unknown-warning-option 2>&1 |
  sed '/^[0-9]* warnings\? generated\.$/d'
