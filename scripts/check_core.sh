#!/usr/bin/env bash
# Builds the core and most of its tests alone, shows that they use no library but glm, oneTBB, Highway, nlohmann-json and Boost's headers
# (and GoogleTest for the tests), and runs those of fields, queries and repair. scripts/test.sh runs all of them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/core
cmake --preset core
cmake --build --preset core --target raymap_core core_tests repair_tests

fail() {
  echo "$1:" >&2
  sed 's/^/  /' <<<"$2" >&2
  exit 1
}

found=$(grep -iE '^(assimp|expat|glslc|imath|openvdb|png|pugixml|volk|vulkan|zip|zlib)' "$build/CMakeCache.txt") || true
if [[ -n $found ]]; then fail "CMake looked for libraries that the core does not need" "$found"; fi

# The packages that own the headers which the compiler read.
headers=$(cd "$build" && ninja -t deps | sed -n 's/^ \+//p' | sort -u | xargs -d '\n' realpath)
headers=$(grep -vF "$PWD/" <<<"$headers" | sort -u)
owners=$(xargs -d '\n' dpkg-query -S <<<"$headers" | sed 's/:.*//' | sort -u)
allowed='libc6-dev|linux-libc-dev|libgcc-[0-9]+-dev|libstdc\+\+-[0-9]+-dev|libglm-dev|libtbb-dev|libhwy-dev|nlohmann-json3-dev|libboost[0-9.]+-dev|libgtest-dev'
others=$(grep -vxE "$allowed" <<<"$owners") || true
if [[ -n $others ]]; then fail "The core reads headers of other packages" "$others"; fi

programs=$(find "$build" -type f -executable ! -path '*/CMakeFiles/*' ! -name '*.so*')
if [[ -z $programs ]]; then fail "Nothing was linked" "$build"; fi
linked=$(xargs -d '\n' readelf -d <<<"$programs" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u)
others=$(grep -vE '^(libtbb|libhwy|libhwy_contrib|libgtest|libgtest_main|libstdc\+\+|libm|libgcc_s|libc|ld-linux.*)\.so' <<<"$linked") || true
if [[ -n $others ]]; then fail "The tests of the core link other libraries" "$others"; fi

ctest --preset core -R '^(Generator|Surface|Keep)\.'
echo "The core needs nothing but:" $(grep -E 'glm|tbb|hwy|nlohmann|boost' <<<"$owners")
