#!/usr/bin/env bash
# Builds for 64-bit ARM (aarch64) with a cross compiler, and runs the result under QEMU. Needs root.
#
# scripts/aarch64.sh          builds in build/aarch64, and runs the tests of core and repair
# scripts/aarch64.sh sysroot  unpacks this distribution's libraries for that processor to build/aarch64-sysroot, no more.
#                             `RAYMAP_SYSROOT=$PWD/build/aarch64-sysroot scripts/wheel.sh` then builds a wheel
# scripts/aarch64.sh check WHEEL  makes fields with such a wheel, by Python and by its program
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh --release
sysroot=$PWD/build/aarch64-sysroot
libraries=(
  libstdc++-12-dev libgtest-dev libassimp-dev libboost-dev libboost-iostreams-dev libdraco-dev libexpat1-dev libglm-dev libhwy-dev
  libnanovdb-dev libopenvdb-dev libpng-dev libpugixml-dev libtbb-dev libvulkan-dev libvulkan-volk-dev libzip-dev nlohmann-json3-dev
  zlib1g-dev libblosc-dev libminizip-dev libutfcpp-dev
)

unpack() { # distribution, folder, packages
  mmdebstrap --variant=extract --architectures=arm64 --include="$3" "$1" "$2" >"$2.log" 2>&1 || { tail -n 20 "$2.log" && exit 1; }
  if [[ ! -e $2/lib ]]; then ln -s usr/lib "$2/lib"; fi
}

if [[ ${1:-} == check ]]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  unpack trixie "$work/system" python3-numpy  # Its Python takes wheels of the stable interface, that of Debian 12 does not.
  python3 -m zipfile -e "$2" "$work/wheel"
  chmod +x "$work"/wheel/raymap.scripts/raymap
  run() { qemu-aarch64-static -L "$work/system" "$@"; }
  raymap=$work/wheel/raymap.scripts/raymap
  run "$raymap" -q example -o "$work/scan.ply" --holes
  run "$raymap" -q generate "$work/scan.ply" -o "$work/program.npy" --resolution 32
  # NumPy's libraries, as alternatives would link them.
  export PYTHONHOME=$work/system/usr PYTHONPATH=$work/wheel:$work/system/usr/lib/python3/dist-packages
  run -E LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu/blas:/usr/lib/aarch64-linux-gnu/lapack "$work/system/usr/bin/python3" - "$work" <<'END'
import platform, sys
import numpy as np
import raymap

field = raymap.generate(f"{sys.argv[1]}/scan.ply", resolution=32)
np.testing.assert_array_equal(field.distance, raymap.load_field(f"{sys.argv[1]}/program.npy").distance)
field.save(f"{sys.argv[1]}/field.vdb")
print(f"raymap {raymap.__version__} works on {platform.machine()} with Python {platform.python_version()}: {field}")
END
  exit
fi

if [[ ! -e $sysroot/complete ]]; then
  rm -rf "$sysroot"
  mkdir -p build
  unpack "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$sysroot" "$(IFS=, && echo "${libraries[*]}")"
  rm -rf "$sysroot/dev"  # QEMU would open /dev/shm there.
  # Some name files from the root on.
  find "$sysroot" -type l -lname '/*' -printf '%p %l\n' | while read -r link file; do ln -sfr "$sysroot$file" "$link"; done
  sed -i -E 's#([:;"])/usr#\1${CMAKE_SYSROOT}/usr#g' "$sysroot"/usr/lib/aarch64-linux-gnu/cmake/{assimp*,draco}/*.cmake
  touch "$sysroot/complete"
fi
if [[ ${1:-} == sysroot ]]; then exit; fi

cmake --preset release -B build/aarch64 --toolchain cmake/aarch64.cmake -DRAYMAP_SYSROOT="$sysroot"
cmake --build build/aarch64 --target raymap_cli core_tests repair_tests
# Death tests start the program again, which only QEMU can. QEMU takes no limit of a process's memory.
ctest --test-dir build/aarch64 --output-on-failure -j 2 -LE large -E '_NOT_BUILT|DeathTest|HeedsTheLimitsOfTheProcess|MakesAllocationsFailIfItIsStrict|^Example'
