#!/usr/bin/env bash
# Builds in Release and measures the errors of signs, points, face orientation, closed holes and repaired meshes. Prints
# the tables of docs/evaluation.md and docs/signs.md, that of closed holes in docs/distances.md, and the points of each
# mesh that docs/points.md sums up. Leaves them, with pictures, in out/evaluation:
#   scripts/evaluate.sh FOLDER [PART...]
# FOLDER holds meshes and a MESHES.tsv that lists them. The parts are the functions below; all of them take about an
# hour, and `repair` goes on where it was stopped. Python packages go into build/bench/evaluation.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:?a folder of meshes}
build=build/bench
out=out/evaluation
python=$build/evaluation/bin/python

signs() { "$build/bin/sign_table" "$folder" | tee "$out/signs.md"; }
points() { "$python" bench/evaluate_points.py "$build/bin/raymap" "$folder" "$out"; }
orientation() { "$python" bench/evaluate_orientation.py "$build/bin/orientation_cases" flipped "$folder" "$out"; }
double_sided() { "$python" bench/evaluate_orientation.py "$build/bin/orientation_cases" doubled "$folder" "$out"; }
close_holes() { "$build/bin/close_holes_table" "$folder/libigl__bunny.off" | tee "$out/close_holes.md"; }
winding_fields() { "$python" bench/evaluate.py "$build/bin/raymap" "$folder" "$out" --only winding_fields; }
deficient_meshes() { "$python" bench/evaluate.py "$build/bin/raymap" "$folder" "$out" --only deficient_meshes; }
repair() { "$python" bench/evaluate_repair.py "$build/bin/raymap" "$folder" --work "$out/repair" | tee "$out/repair.md"; }
repair_warnings() { "$python" bench/check_warnings.py "$build/bin/raymap" "$folder" --work "$out/repair" | tee "$out/repair_warnings.md"; }
repair_pictures() { "$python" bench/repair_pictures.py "$build/bin/raymap" "$folder" "$out/repair.png" --work "$out/repair"; }

parts=("${@:2}")
if [[ ${#parts[@]} -eq 0 ]]; then parts=(signs points orientation double_sided close_holes winding_fields deficient_meshes repair repair_warnings repair_pictures); fi
for part in "${parts[@]}"; do
  declare -F "$part" >/dev/null || { echo "$part is not a part" >&2 && exit 2; }
done

scripts/install.sh --bench >&2
cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF >&2
cmake --build "$build" >&2
packages="numpy scipy libigl open3d trimesh pillow"
if [ "$(cat "$build/evaluation/complete" 2>/dev/null)" != "$packages" ]; then
  python3 -m venv "$build/evaluation" >&2
  "$build/evaluation/bin/pip" install --quiet $packages >&2
  echo "$packages" >"$build/evaluation/complete"
fi

mkdir -p "$out"
for part in "${parts[@]}"; do
  echo "## $part"
  "$part"
done
echo "Tables and pictures: $out"
