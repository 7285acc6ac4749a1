#!/usr/bin/env bash
# Builds in Release and measures how right signs, turned faces, closed holes and repaired meshes are; prints the tables
# of docs/evaluation.md, docs/signs.md and docs/distances.md and leaves them, with pictures, in out/evaluation:
#   scripts/evaluate.sh FOLDER
# FOLDER holds meshes and a MESHES.tsv that lists them. It takes about an hour. Python packages go into build/bench/evaluation.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:?a folder of meshes}
build=build/bench
out=out/evaluation
scripts/install.sh --bench >&2

cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON >&2
cmake --build "$build" >&2
if [ ! -e "$build/evaluation/complete" ]; then
  python3 -m venv "$build/evaluation" >&2
  "$build/evaluation/bin/pip" install --quiet numpy libigl pillow >&2
  touch "$build/evaluation/complete"
fi

mkdir -p "$out"
echo "## Sign modes" && "$build/bin/sign_table" "$folder" | tee "$out/signs.md"
echo "## Turned faces" && "$build/bin/orientation_table" "$folder" | tee "$out/orientation.md"
echo "## Closed holes" && "$build/bin/close_holes_table" "$folder/libigl__bunny.off" | tee "$out/close_holes.md"
"$build/evaluation/bin/python" bench/evaluate.py "$build/bin/raymap" "$folder" "$out"
echo "## Repair" && python3 bench/evaluate_repair.py "$build/bin/raymap" "$folder" | tee "$out/repair.md"
echo "Tables and pictures: $out"
