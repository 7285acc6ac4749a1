#!/usr/bin/env bash
# Builds libraries for wheels from this distribution's sources, in build/small-libraries: OpenVDB without instances of its
# templates for all types, and Assimp without readers but those of FBX and DAE. A wheel is 11 MB smaller with them.
#
# scripts/small_libraries.sh [SYSROOT]: with SYSROOT, for aarch64, into its folder usr/local (scripts/aarch64.sh)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh --release
sources=$PWD/build/small-libraries/sources
place=(-DCMAKE_INSTALL_PREFIX="$PWD/build/small-libraries")
build=build-x86_64
if [[ $# -gt 0 ]]; then
  place=(--toolchain "$PWD/cmake/aarch64.cmake" -DRAYMAP_SYSROOT="$1" -DCMAKE_INSTALL_PREFIX=/usr/local)
  build=build-aarch64
  export DESTDIR=$1
fi

fetch() { # arguments of apt-get source
  apt-get -q -o Dir::Etc::SourceList="$sources/list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$sources/lists" "$@"
}
mkdir -p "$sources/lists"
if [[ ! -e $sources/complete ]]; then
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  sed -n -E "s#^(URIs:|deb) +(http[^ ]*).*#deb-src \\2 $codename main#p" /etc/apt/sources.list.d/*.sources /etc/apt/sources.list 2>/dev/null |
    head -n 1 >"$sources/list" || true
  cd "$sources"
  fetch update
  fetch source assimp  # With Debian's patches, by which it takes Debian's libraries.
  fetch source --tar-only openvdb
  tar -xf openvdb_*.orig.tar.*
  touch complete
fi

install_library() { # folder, options
  local folder=$1
  shift
  cmake -S "$folder" -B "$folder/$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_LIBDIR=lib "${place[@]}" \
    -DCMAKE_C_COMPILER_LAUNCHER="$(type -P ccache)" -DCMAKE_CXX_COMPILER_LAUNCHER="$(type -P ccache)" "$@"
  cmake --build "$folder/$build"
  cmake --install "$folder/$build" --strip
}
cd "$sources"
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
install_library openvdb-*/ -DOPENVDB_CORE_STATIC=OFF -DOPENVDB_BUILD_BINARIES=OFF -DUSE_EXPLICIT_INSTANTIATION=OFF \
  -DUSE_BLOSC=ON -DUSE_ZLIB=ON -DUSE_IMATH_HALF=ON -DOPENVDB_USE_DELAYED_LOADING=OFF  # Raymap reads whole files.
install_library assimp-*/ -DASSIMP_BUILD_ALL_IMPORTERS_BY_DEFAULT=OFF -DASSIMP_BUILD_FBX_IMPORTER=ON \
  -DASSIMP_BUILD_COLLADA_IMPORTER=ON -DASSIMP_NO_EXPORT=ON -DASSIMP_BUILD_TESTS=OFF -DASSIMP_WARNINGS_AS_ERRORS=OFF
