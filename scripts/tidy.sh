#!/usr/bin/env bash
# Runs clang-tidy on our own sources in parallel. Arguments choose files: scripts/tidy.sh apps/main.cpp
# Without any it reads several files at a time, as unity builds do (tidy_units.py): half of the time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
version=23.1.4  # From 21 on it passes over the headers of libraries, which takes a third of the time.
env=build/tidy-env
if ! "$env/bin/pip" show clang-tidy 2>/dev/null | grep -qxF "Version: $version"; then
  python3 -m venv "$env"
  "$env/bin/pip" install --quiet --disable-pip-version-check "clang-tidy==$version"
fi
unity=OFF commands=build/tidy files=("$@")
if [[ $# -eq 0 ]]; then unity=ON commands=build/tidy/units; fi
cmake --preset release -B build/tidy -DCMAKE_UNITY_BUILD=$unity >/dev/null
cmake --build build/tidy --target raymap_vulkan_shaders raymap_page_text raymap_view_shaders >/dev/null
mapfile -t units < <(scripts/tidy_units.py make build/tidy)
if [[ $# -eq 0 ]]; then files=("${units[@]}"); fi
# The analyzer gives up on a function after a tenth of the states that it may visit by default, for another third.
analyzer=(--extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=22500)
gcc_only=(--extra-arg=-Wshadow-uncaptured-local --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-deprecated-declarations)
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" "$env/bin/clang-tidy" -p $commands --quiet "${analyzer[@]}" "${gcc_only[@]}" 2>&1 |
  scripts/tidy_units.py name build/tidy | sed '/^[0-9]* warnings\? generated\.$/d'
