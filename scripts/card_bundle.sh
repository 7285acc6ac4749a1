#!/usr/bin/env bash
# Makes the folder build/card_bundle for somebody who has a graphics card and nothing else: the tests and benchmarks of the
# GPU, and every shared library that they need but the C library's. docs/dev/measurements.md says how it is used.
#
# scripts/card_bundle.sh FOLDER: FOLDER holds meshes to measure, the scan draco__bun_zipper.ply among them.
set -euo pipefail
meshes=$(realpath -- "${1:?the folder of meshes}")
[[ -e $meshes/draco__bun_zipper.ply ]] || { echo "$meshes: no draco__bun_zipper.ply; the tables need that scan" >&2 && exit 1; }
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh --bench
build=build/card
bundle=build/card_bundle
programs=(raymap vulkan_tests gpu_bench)
most_megabytes=40

cmake --preset release -B "$build" -DRAYMAP_OPENVDB=OFF -DRAYMAP_ASSIMP=OFF -DRAYMAP_DRACO=OFF -DRAYMAP_VIEW=OFF -DRAYMAP_BUILD_BENCH=ON
cmake --build "$build" --target raymap_cli vulkan_tests gpu_bench
rm -rf "$bundle"
mkdir -p "$bundle"/{bin,lib,spare,meshes}
for program in "${programs[@]}"; do strip -o "$bundle/bin/$program" "$build/bin/$program"; done
cp bench/card/{run.sh,*.py} bench/gpu_{program,tables}.py bench/charts.py "$bundle"
cp -rL "$meshes/." "$bundle/meshes"
rm -f "$bundle/meshes/MESHES.tsv"  # Tests that look for it want all meshes of its folder.

# A driver may need a newer one of these than ours, so bench/card/libraries.py prefers the system's.
libraries_of() { ldd "$@" | sed -n 's|.* => \(/[^ ]*\) .*|\1|p' | sort -u; }
of_drivers=$(libraries_of /usr/lib/*/libvulkan_*.so | xargs -n 1 basename)
loader=$(ldconfig -p | sed -n 's|.*libvulkan\.so\.1 .*x86-64.* => ||p' | head -n 1)
of_glibc='lib(c|m|dl|rt|pthread|resolv)\.so\.[0-9]+'  # It belongs together with the system's program loader.
for library in $(libraries_of "${programs[@]/#/$bundle/bin/}") "$loader"; do
  name=$(basename "$library")
  if grep -qxE "$of_glibc" <<<"$name"; then continue; fi
  folder=lib
  if grep -qxF "$name" <<<"$of_drivers"; then folder=spare; fi
  cp -L "$library" "$bundle/$folder/$name"
  scripts/copy_licence.sh "$name" "$bundle/licences"
done

glibc=$(objdump -T "$bundle"/{bin,lib,spare}/* | grep -oE 'GLIBC_[0-9.]+' | sort -uV | tail -n 1)
echo "Raymap $(git describe --always --dirty 2>/dev/null || true), x86-64, $glibc or newer" >"$bundle/bundle.txt"
bytes=$(du -sb "$bundle" | cut -f1)
echo "$bundle: $((bytes / 1000)) kB, for $glibc or newer"
if [[ $bytes -gt $((most_megabytes * 1000000)) ]]; then
  echo "That is more than $most_megabytes MB. Give it fewer meshes." >&2
  exit 1
fi
