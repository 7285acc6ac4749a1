#!/usr/bin/env bash
# Formats every C++ file. With --check, it only reports those that differ.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=(-i)
if [[ ${1:-} == --check ]]; then mode=(--dry-run -Werror); fi
git ls-files -z '*.cpp' '*.h' | xargs -0 clang-format "${mode[@]}"
