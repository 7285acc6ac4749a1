#!/usr/bin/env bash
# Runs the GPU's tests on lavapipe with vectors of 128 or 512 bits: with subgroups of 4 or 16 invocations instead of 8.
# Arguments after the first go to ctest: scripts/test_subgroups.sh 512 -R ExactDistance
# Any x86-64 CPU can run 512: LLVM splits vectors that are wider than the CPU's. Without AVX-512 it takes longer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
width=${1:?usage: scripts/test_subgroups.sh 128|512 [arguments of ctest]}
shift
# Mesa's cache of compiled kernels does not distinguish these widths, so each gets a cache of its own.
export MESA_SHADER_CACHE_DIR=$PWD/build/shaders_$width
mkdir -p "$MESA_SHADER_CACHE_DIR"
# Tests of the device alone, those whose kernels use no subgroups, and those that run again what others run. Of whole
# fields, one test stays.
device='Buffer|Command|Device|Dispatch|Errors|Instance|Pipelines|SelfTest|ShaderArithmetic|Spirv|StageTimer|WorkCounter'
stages='CloseHoles|DistanceTransform|Frames|Render|Skin|WindingHarmonic|WindingPaths'
left_out="Vulkan($device|$stages|Generator\.[^M])|OnRealMeshes|AllocatesNothing"
export RAYMAP_REQUIRE_VULKAN=1 LP_NATIVE_VECTOR_WIDTH=$width
ctest --preset release -R Vulkan -E "$left_out" "$@"
