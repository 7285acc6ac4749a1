#!/usr/bin/env bash
# Installs, by apt, those packages that are missing: to build and test, with --checks what CI's checks need too, with
# --bench what the benchmarks need, and with --release what the files of a release need.
# The names are the same on Debian 12 and 13 and Ubuntu 24.04.
set -euo pipefail

packages=(
  ca-certificates git            # to get here
  g++ cmake ninja-build          # to build
  libtbb-dev                     # threads
  libhwy-dev                     # SIMD
  libglm-dev                     # vectors
  libassimp-dev                  # FBX and DAE
  libdraco-dev                   # compressed glTF
  nlohmann-json3-dev             # glTF, statistics
  libpng-dev zlib1g-dev          # pictures, compressed fields
  glslc spirv-cross              # shaders, also in the language of browsers
  libpugixml-dev libzip-dev libexpat1-dev  # .vti, .npz and .3mf
  libboost-dev                   # integers of any size
  libopenvdb-dev libboost-iostreams-dev  # .vdb (and a benchmark's peer), and what its headers need
  libnanovdb-dev                 # .nvdb
  libvulkan-dev libvulkan-volk-dev  # GPUs: headers, the loader's loader;
  mesa-vulkan-drivers vulkan-validationlayers  # and a GPU in software to test on, and checks of how it is used
  libglfw3-dev libimgui-dev fonts-dejavu-core  # the window, and its font
  libgtest-dev python3-numpy     # tests
  python3-dev python3-venv       # the Python package; what it and its tests need from PyPI: scripts/python_env.sh
)
checks=(
  ccache                         # so that the second build of a file is free
  clang clang-format             # sanitizers, fuzzing, formatting
  universal-ctags                # names that two files define
  libusb-1.0-0 libgl1 libgomp1   # Open3D, whose meshes the Python package takes
  libeigen3-dev                  # pysdf, with which the Python package is compared
  pkg-config                     # the installed library
  chromium-driver                # pages in a browser
  xvfb xdotool                   # the window
  libnanovdb-tools               # another judge of .nvdb files
  doxygen                        # the documentation site
)
peers=(
  libembree-dev                  # exact peer
  admesh                         # another judge of repaired meshes
  python3-venv                   # the Python peers come from PyPI,
  libusb-1.0-0 libgl1 libgomp1 libeigen3-dev  # and two of them need these
)
release=(
  debhelper lintian              # Debian's packages
  dpkg-dev libutfcpp-dev libminizip-dev libblosc-dev  # to build OpenVDB and Assimp from sources
  mmdebstrap                     # systems of another architecture
  crossbuild-essential-arm64 qemu-user-static  # to build for it, and run that
)
if [[ ${1:-} == --bench ]]; then packages+=("${peers[@]}"); fi
if [[ ${1:-} == --checks ]]; then packages+=("${checks[@]}"); fi
if [[ ${1:-} == --release ]]; then packages+=("${release[@]}"); fi

asRoot=(env DEBIAN_FRONTEND=noninteractive)
if [[ $(id -u) -ne 0 ]]; then asRoot=(sudo "${asRoot[@]}"); fi
update() { "${asRoot[@]}" apt-get update -q </dev/null; }

# The newest Clang of the distribution tries the installed library. Without package lists there is no telling which it is,
# and `clang` has to do where there is no apt.
newestClang() { apt-cache pkgnames clang- | grep -xE 'clang-[0-9]+' | sort -t- -k2 -n | tail -n 1; }
if [[ ${1:-} == --checks ]] && type -P apt-get "${asRoot[0]}" >/dev/null; then
  if [[ -z $(newestClang) ]]; then update; fi
  packages+=($(newestClang)) || true
  # Sanitizers need the runtime of the default Clang, which its package only recommends.
  packages+=($(apt-cache depends clang | sed -n 's/.*Depends: clang-\([0-9]*\)$/libclang-rt-\1-dev/p')) || true
fi

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi

if ! type -P apt-get "${asRoot[0]}" >/dev/null; then
  echo "Missing: ${missing[*]}. Install them as root by apt, or install sudo." >&2
  exit 1
fi
echo "Installing ${missing[*]}"
install=(apt-get install -y -q --no-install-recommends "${missing[@]}")
# A fresh machine has no package lists, or stale ones: fetch them only then.
"${install[@]}" --simulate </dev/null &>/dev/null || update
"${asRoot[@]}" "${install[@]}" </dev/null || {
  update
  "${asRoot[@]}" "${install[@]}" </dev/null
}
