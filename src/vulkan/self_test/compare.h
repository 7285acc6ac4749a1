#pragma once

// Comparisons of stages with the CPU's, on any mesh. Each throws a `Difference`.

#include <raymap/options.h>

#include "vulkan/self_test/cell_probe.h"
#include "vulkan/self_test/sign_probe.h"
#include "vulkan/stages/winding_harmonic.h"
#include "vulkan/stages/winding_paths.h"
#include "vulkan/stages/winding_rims.h"

namespace raymap::vulkan {

/// Compares the prefix sums of random numbers, out of place, in place, and with a count of the device's.
void compareScan(const Probe& probe, uint32_t count);
/// Compares the order of random keys, and of those that are equal.
void compareRadixSort(const Probe& probe, uint32_t count);

void compareVoxelGrid(CellProbe& probe, const CellMesh& mesh, const CellLattice& cells);
void compareCellDistance(CellProbe& probe, const CellMesh& mesh, const CellLattice& cells);
void compareTransform(CellProbe& probe, const glm::ivec3& dims, const Buffer<float>& squared);
/// Compares the distances of every sample and the closest triangles, and all results before them.
void compareRefine(CellProbe& probe, const CellMesh& mesh, int reach);
void compareRasterDistance(CellProbe& probe, const CellMesh& mesh);

void compareCrossings(SignProbe& probe, const CellMesh& mesh);
/// Compares the rays, the winding numbers and the count of doubtful samples.
void compareRays(SignProbe& probe, const CellMesh& mesh, SignMode mode);
void compareHarmonic(const Probe& probe, WindingHarmonicStage& stage, const cpu::RayMap& map);
/// Compares the numbers that follow from rims, and those that rims decide near the threshold.
void compareRims(const Probe& probe, WindingRimsStage& stage, const glm::ivec3& dims,
                 const cpu::Crossings& crossings, const RimLattices& lattices);
void comparePaths(const Probe& probe, WindingPathsStage& stage, const cpu::RayMap& map,
                  const FieldOptions& options);

}  // namespace raymap::vulkan
