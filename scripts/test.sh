#!/usr/bin/env bash
# Installs missing packages, builds, and runs the tests but those with the label `large`; with --all, every test. Further
# arguments go to ctest: scripts/test.sh -R sign
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
labels=(-LE large)
if [[ ${1:-} == --all ]]; then labels=() && shift; fi
scripts/install.sh
export RAYMAP_REQUIRE_VULKAN=1  # A missing driver fails the tests of the GPU instead of skipping them.
cmake --preset release -DRAYMAP_PYTHON=ON -DPython_EXECUTABLE="$(scripts/python_env.sh)"
cmake --build --preset release
ctest --preset release "${labels[@]}" "$@"
