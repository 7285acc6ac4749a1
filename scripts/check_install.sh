#!/usr/bin/env bash
# Installs the library, static and shared, into build/install and builds and runs a small project against each: once
# with find_package, once with pkg-config.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$(pwd)/build/install

check() { # kind, value of BUILD_SHARED_LIBS, what pkg-config needs
  build=$root/$1-build
  prefix=$root/$1
  rm -rf "$prefix" "$root/$1-consumer"
  cmake --preset release -B "$build" -DBUILD_SHARED_LIBS="$2" -DRAYMAP_BUILD_TESTS=OFF -DCMAKE_INSTALL_PREFIX="$prefix" >"$root/$1.log"
  cmake --build "$build" >>"$root/$1.log"
  cmake --install "$build" >>"$root/$1.log"
  "$prefix/bin/raymap" --version

  echo "$1, find_package:"
  cmake -S tests/consumer -B "$root/$1-consumer" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >>"$root/$1.log"
  cmake --build "$root/$1-consumer" >>"$root/$1.log"
  "$root/$1-consumer/consumer"
  if [[ -x $root/$1-consumer/vulkan_consumer ]]; then
    "$root/$1-consumer/vulkan_consumer" || [[ $? -eq 77 ]]  # It says that there is no device.
  fi

  echo "$1, pkg-config:"
  libraries=$(dirname "$(dirname "$(find "$prefix" -name raymap.pc)")")
  # pkg-config answers with words as a shell reads them, spaces escaped.
  eval "flags=($(PKG_CONFIG_PATH="$libraries/pkgconfig" pkg-config --cflags --libs $3 raymap))"
  ${CXX:-c++} -std=c++20 tests/consumer/consumer.cpp -o "$root/$1-consumer/by_pkg_config" "${flags[@]}"
  LD_LIBRARY_PATH="$libraries" "$root/$1-consumer/by_pkg_config"
}

mkdir -p "$root"
check static "" --static  # as it comes
check shared ON ""
echo "The installed library works, static and shared, with find_package and pkg-config."
