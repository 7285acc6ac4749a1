#!/usr/bin/env bash
# Runs clang-tidy on our own sources in parallel. Arguments choose files: scripts/tidy.sh apps/main.cpp
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
version=23.1.4  # From 21 on it passes over the headers of libraries, which takes a third of the time.
env=build/tidy-env
if ! "$env/bin/pip" show clang-tidy 2>/dev/null | grep -qxF "Version: $version"; then
  python3 -m venv "$env"
  "$env/bin/pip" install --quiet --disable-pip-version-check "clang-tidy==$version"
fi
# Each file by itself: this is also the check that it includes what it needs, as the other builds compile several together.
cmake --preset release -B build/tidy -DCMAKE_UNITY_BUILD=OFF >/dev/null
cmake --build build/tidy --target raymap_vulkan_shaders raymap_page_text raymap_view_shaders >/dev/null
files=("$@")
# Clang does not compile Boost's headers of Debian 12 any more, which OpenVDB's include, nor what includes those.
if [[ ${#files[@]} -eq 0 ]]; then
  uses_openvdb='<openvdb/'
  for header in $(git grep -l '<openvdb/' -- 'src/*.h'); do uses_openvdb+="|${header#src/}"; done
  mapfile -t files < <(git ls-files 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp' | xargs grep -LE "$uses_openvdb")
fi
# The analyzer gives up on a function after a tenth of the states that it may visit by default, for another third.
analyzer=(--extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=22500)
gcc_only=(--extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-deprecated-declarations)
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" "$env/bin/clang-tidy" -p build/tidy --quiet "${analyzer[@]}" "${gcc_only[@]}" 2>&1 |
  sed '/^[0-9]* warnings\? generated\.$/d'
