#!/usr/bin/env bash
# Makes the bundle for somebody who has a card (scripts/card_bundle.sh), and runs a part of it in a bare system of this
# distribution that holds nothing but Python and a Vulkan driver in software. Needs root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir "$work/meshes"
printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' >"$work/meshes/tetrahedron.off"
python3 - "$work/meshes/draco__bun_zipper.ply" <<'END'  # A sphere in place of the scan.
import math, sys
n = 60
places = [(math.sin(b) * math.cos(a), math.sin(b) * math.sin(a), math.cos(b))
          for b in (math.pi * (i + 0.5) / n for i in range(n)) for a in (2 * math.pi * j / n for j in range(n))]
faces = [(n * i + j, n * (i + 1) + (j + 1 - d) % n, n * (i + d) + (j + 1) % n) for i in range(n - 1) for j in range(n) for d in (1, 0)]
with open(sys.argv[1], "w") as file:
    file.write(f"ply\nformat ascii 1.0\nelement vertex {n * n}\nproperty float x\nproperty float y\nproperty float z\n"
               f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    file.writelines(f"{x} {y} {z}\n" for x, y, z in places)
    file.writelines(f"3 {a} {b} {c}\n" for a, b, c in faces)
END
scripts/card_bundle.sh "$work/meshes"
scripts/bare_system.sh make "$work/system" python3,mesa-vulkan-drivers
cp -r build/card_bundle "$work/system/bundle"

run() { scripts/bare_system.sh run "$work/system" /bundle/run.sh "$@"; }
expect() { # file, pattern
  grep -qE -- "$2" "$work/system/$1" || { echo "$1 has no line '$2':" && cat "$work/system/$1" && exit 1; }
}

steps=(devices vulkan_tests_1 vulkan_tests_2 fields counted-scan counted-million meshes resolutions)
run /results --quick
for step in "${steps[@]}"; do expect results/summary.md "^\| $step \| exit code 0 \| [0-9.]+ \|$"; done
expect results/devices/log.txt '^passed [0-9]+ checks'
expect results/vulkan_tests_1/log.txt '^[0-9]+ passed, [0-9]+ skipped, 0 failed$'
expect results/meshes/tables.md '^\| 24 samples \| Vulkan, exact\+harmonic \| 1 \|'
tar -tzf "$work/system/results/results.tar.gz" results/meshes/runtime_over_meshes.svg

# The bundle's own libraries serve where the system lacks Vulkan's loader or C++'s library. The driver needs the latter,
# too. Containers have NVIDIA's driver in a folder of its own.
rm "$work/system"/usr/lib/*/libstdc++.so.6* "$work/system"/usr/lib/*/libvulkan.so.1*
mkdir -p "$work/system/usr/local/nvidia/share"
mv "$work/system/usr/share/vulkan" "$work/system/usr/local/nvidia/share"
run /results devices
expect results/summary.md '^\| devices \| exit code 0 \|'

# Without a driver, every step fails and the next one is run.
rm -r "$work/system/usr/local/nvidia"
if run /results devices vulkan_tests_1; then exit 1; fi
for step in devices vulkan_tests_1; do expect results/summary.md "^\| $step \| exit code [1-9]"; done
expect results/devices/log.txt 'no Vulkan driver'
