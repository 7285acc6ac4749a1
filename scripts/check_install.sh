#!/usr/bin/env bash
# Installs the library into a temporary folder, static, shared, as its core alone, and without OpenVDB and Assimp. Programs
# of somebody else's (tests/consumer) must then build and run, as README says: with GCC and the newest Clang, by CMake and
# by pkg-config, with warnings as errors and nothing set in the environment.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
unset RAYMAP_IMPORT LD_LIBRARY_PATH LIBRARY_PATH CPATH CFLAGS CXXFLAGS LDFLAGS PKG_CONFIG_PATH CMAKE_PREFIX_PATH
export CCACHE_BASEDIR=$PWD  # Builds share what they compiled.

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
warnings="-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Werror"
newest_clang=$(compgen -c clang++- | grep -xE 'clang\+\+-[0-9]+' | sort -u -t- -k2 -n | tail -n 1)
compilers=("${CXX:-g++}" "${newest_clang:-clang++}")

# README shows what is tried here, word for word.
trim() { sed 's/^ *//; s/ *$//' "$@"; }
shown=$(awk '/^```(cpp|cmake|sh)$/ { inside = 1; next } /^```/ { inside = 0 } inside && NF' README.md | trim)
unknown=$(grep -vxFf <(trim tests/consumer/app.cpp tests/consumer/CMakeLists.txt scripts/check_install.sh) <<<"$shown") || true
if [[ -n $unknown ]]; then
  echo "README.md shows lines that neither tests/consumer nor this script tries:"
  echo "$unknown"
  exit 1
fi

mkdir -p build
cp tests/consumer/tetrahedron.dae "$work"
cp -r tests/consumer "$work/consumer"

install_library() { # kind, options of CMake
  # As deep as build/release: relative paths are then the same, and a compiler cache serves both.
  local kind=$1 build=build/install_$1
  shift
  echo "building: $kind"
  {
    cmake --preset release -B "$build" -DRAYMAP_BUILD_TESTS=OFF "$@" &&
      cmake --build "$build" &&
      cmake --install "$build" --prefix "$work/staging"
  } >"$build.log" 2>&1 || { tail -n 40 "$build.log" && exit 1; }
  mv "$work/staging" "$work/$kind"  # Nothing may depend on the folder that it was installed to.
}

# Each check below runs in the background; its output appears if it fails.
checks=()
check() {
  ("$@") >"$work/log ${*//\//-}" 2>&1 &
  checks+=("$! $*")
}

run() { # program: in a folder that holds the DAE and nothing else
  local folder
  folder=$(mktemp -d -p "$work")
  cp "$work/tetrahedron.dae" "$folder"
  (cd "$folder" && "$@")
}

copy_elsewhere() { # program
  local folder
  folder=$(mktemp -d -p "$work")
  cp "$1" "$folder/app"
  echo "$folder/app"
}

c_compiler() { sed 's/clang++/clang/; s/g++/gcc/' <<<"$1"; }

check_program() { # kind
  "$work/$1/bin/raymap" --version
  run "$work/$1/bin/raymap" info tetrahedron.dae
}

check_cmake() { # kind, compiler, project in tests/consumer
  local kind=$1 compiler=$2 project=$3 build="$work/$1-$2-$3"
  local forbidden=()
  if [[ $project == core || $project == refused ]]; then forbidden=(-DCMAKE_DISABLE_FIND_PACKAGE_{PNG,ZLIB,EXPAT,Imath,Vulkan,nlohmann_json,assimp}=ON); fi
  set -x
  cmake -S "$work/consumer/$project" -B "$build" -G Ninja -DCMAKE_PREFIX_PATH="$work/$kind" \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_C_COMPILER="$(c_compiler "$compiler")" \
    -DCMAKE_CXX_FLAGS="$warnings" -DCMAKE_C_FLAGS="$warnings" "${forbidden[@]}"
  cmake --build "$build"
  run "$build/app"
  run "$(copy_elsewhere "$build/app")"
  if [[ $project == . && $kind == static ]]; then
    cmake --install "$build" --prefix "$build/installed"
    run "$build/installed/bin/app"
  fi
  if [[ -x $build/vulkan_app ]]; then
    run "$build/vulkan_app" || [[ $? -eq 77 ]]  # It says that there is no device.
  fi
}

check_pkg_config() { # kind, compiler
  local folder="$work/$1-$2-pkg-config"
  cp -r "$work/consumer" "$folder"
  cd "$folder"
  PKG_CONFIG_PATH=$(dirname "$(find "$work/$1" -name raymap.pc)")
  export PKG_CONFIG_PATH
  local compiler=$2
  c++() { "$compiler" $warnings "$@"; }
  cc() { "$(c_compiler "$compiler")" $warnings "$@"; }
  set -x
  c++ -std=c++20 app.cpp $(pkg-config --cflags --libs raymap) -Wl,-rpath,$(pkg-config --variable=libdir raymap) -o app
  run "$folder/app"
  run "$(copy_elsewhere "$folder/app")"
  cc -std=c11 c/app.c $(pkg-config --cflags --libs raymap) -Wl,-rpath,$(pkg-config --variable=libdir raymap) -o c_app
  run "$folder/c_app"
}

check_headers() { # kind, compiler: each by itself, also its inline functions
  local header
  # Not as a system's headers, as CMake includes them: compilers hide the warnings of those.
  for header in "$work/$1"/include/raymap/*.h; do
    "$2" -x c++ -std=c++20 $warnings -I "$work/$1/include" -fsyntax-only - <<<"#include <raymap/${header##*/}>"
  done
  "$(c_compiler "$2")" -x c -std=c11 $warnings -I "$work/$1/include" -fsyntax-only - <<<'#include <raymap/c.h>'
}

check_missing() { # kind: what was not built is refused by name
  if cmake -S "$work/consumer/missing" -B "$work/$1-missing" -G Ninja -DCMAKE_PREFIX_PATH="$work/$1"; then return 1; fi 2>"$work/missing.txt"
  tr -s ' \n' ' ' <"$work/missing.txt" | grep -F "has no component 'io', only: core. Build raymap with RAYMAP_IO=ON."
}

only_core=(-DRAYMAP_VULKAN=OFF -DRAYMAP_IO=OFF -DRAYMAP_RENDER=OFF)
install_library static -DBUILD_SHARED_LIBS=OFF
check check_program static
for compiler in "${compilers[@]}"; do
  check check_headers static "$compiler"
  check check_cmake static "$compiler" .
  check check_cmake static "$compiler" core
  check check_cmake static "$compiler" c
  check check_pkg_config static "$compiler"
done
install_library core "${only_core[@]}"
check check_missing core
for compiler in "${compilers[@]}"; do
  check check_cmake core "$compiler" core
  check check_cmake core "$compiler" refused
done
install_library light "${only_core[@]}" -DRAYMAP_IO=ON -DRAYMAP_OPENVDB=OFF -DRAYMAP_ASSIMP=OFF -DRAYMAP_DRACO=OFF
for compiler in "${compilers[@]}"; do check check_cmake light "$compiler" light; done
install_library shared -DBUILD_SHARED_LIBS=ON
check check_program shared
for compiler in "${compilers[@]}"; do
  check check_cmake shared "$compiler" .
  check check_cmake shared "$compiler" core
  check check_cmake shared "$compiler" c
  check check_pkg_config shared "$compiler"
done

failed=0
for each in "${checks[@]}"; do
  name=${each#* }
  if wait "${each%% *}"; then
    echo "passed: $name"
  else
    failed=$((failed + 1))
    echo "FAILED: $name"
    cat "$work/log ${name//\//-}"
  fi
done
if [[ $failed -gt 0 ]]; then exit 1; fi
echo "The installed library works with ${compilers[*]}."
