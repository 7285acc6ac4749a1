#!/usr/bin/env bash
# Installs missing packages, builds, and makes signed distance fields and pictures of an example mesh, whole and torn.
# Results are in out/demo/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh
cmake --preset release
cmake --build --preset release --target raymap_cli

raymap=build/release/bin/raymap
out=out/demo
mkdir -p "$out"
"$raymap" example -o "$out/globe.ply"
"$raymap" example -o "$out/torn.ply" --holes
# Both fields get the same box, so they can be compared.
box=(--resolution 256 --bounds -1.8 -2.65 -1.4 1.8 2.35 1.4)

echo
"$raymap" generate "$out/globe.ply" -o "$out/globe.nrrd" "${box[@]}" --stats "$out/globe.json"
"$raymap" convert "$out/globe.nrrd" "$out/globe.vdb"
"$raymap" render "$out/globe.nrrd" -o "$out/globe.png"
"$raymap" render "$out/globe.nrrd" -o "$out/half.png" --cut --shell 0.04
"$raymap" render "$out/globe.nrrd" -o "$out/slice.png" --slice z

echo
echo "The same with holes torn into it: the inside is still found."
"$raymap" generate "$out/torn.ply" -o "$out/torn.nrrd" "${box[@]}" --stats "$out/torn.json"
"$raymap" convert "$out/torn.nrrd" "$out/torn.vdb"
"$raymap" render "$out/torn.nrrd" -o "$out/torn.png"
echo "Against the whole one:"
"$raymap" compare "$out/globe.nrrd" "$out/torn.nrrd" -o "$out/difference.png"

echo
echo "Look at:"
ls -1 "$PWD/$out"/*
