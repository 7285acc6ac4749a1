#pragma once

// Comparisons of stages with the CPU's, or with brute force, on any mesh. Each throws a `Difference`.

#include <raymap/animation.h>
#include <raymap/options.h>
#include <raymap/picture.h>

#include "testing/cell_meshes.h"
#include "vulkan/runtime/backend.h"
#include "vulkan/self_test/cell_probe.h"
#include "vulkan/self_test/sign_probe.h"
#include "vulkan/self_test/surface_probe.h"
#include "vulkan/stages/close_holes.h"
#include "vulkan/stages/face_search.h"
#include "vulkan/stages/winding_harmonic.h"
#include "vulkan/stages/winding_paths.h"
#include "vulkan/stages/winding_rims.h"

namespace raymap::vulkan {

/// Compares the prefix sums of random numbers, out of place and in place.
void compareScan(const Probe& probe, uint32_t count);
/// Compares the order of random keys by their lowest bits, and of those that are equal.
void compareRadixSort(const Probe& probe, uint32_t count, uint32_t bits);

void compareVoxelGrid(CellProbe& probe, const CellMesh& mesh, const CellLattice& cells);
void compareTransform(CellProbe& probe, const glm::ivec3& dims, const Buffer<float>& squared);
/// Compares the distances of every sample and the closest triangles, and all results before them.
void compareRefine(CellProbe& probe, const CellMesh& mesh, int reach);
void compareRasterDistance(CellProbe& probe, const CellMesh& mesh);

/// Checks that the tree lists every triangle once, at most `allowed` cells outside the discs of all nodes
/// above it. Returns the tree.
TreeOnHost checkTree(SurfaceProbe& probe, const CellMesh& mesh, double allowed);
/// Checks closest triangles by brute force in double precision, which looks at about `looks` triangles, and
/// those in a band.
void checkClosest(SurfaceProbe& probe, const OwnCellMesh& mesh, float band, double looks = 1e6);
/// Checks the winding numbers of all samples by brute force in double precision.
void checkSettled(SurfaceProbe& probe, WindingDipolesStage& dipoles, const OwnCellMesh& mesh);
/// Searches in a mesh, which may have fewer vertices and faces than are reserved.
void searchFaces(const Probe& probe, FaceSearchStage& search, const Mesh& mesh);
/// Compares what the host finds among what the device lists.
void compareFaceSearch(const Probe& probe, FaceSearchStage& search, const Mesh& mesh);

/// Compares the crossings, the rays, the winding numbers and the count of doubtful samples.
void compareRays(SignProbe& probe, const CellMesh& mesh, SignMode mode);
void compareHarmonic(const Probe& probe, WindingHarmonicStage& stage, const cpu::RayMap& map);
/// Compares the numbers that follow from rims, and those that rims decide near the threshold.
void compareRims(const Probe& probe, WindingRimsStage& stage, const glm::ivec3& dims,
                 const cpu::Crossings& crossings, const RimLattices& lattices);
void comparePaths(const Probe& probe, WindingPathsStage& stage, const cpu::RayMap& map,
                  const FieldOptions& options);
/// Compares the edges at which surface is missing, given any winding numbers.
void compareMissingEdges(const Probe& probe, CloseHolesStage& stage, const CellMesh& mesh,
                         const Buffer<float>& winding);

struct Made {
  Field field;
  Stats stats;
};
/// Makes a field by the backend whose results the host reads back.
Made makeField(Backend& backend, const Mesh& mesh, const Grid& grid, const FieldOptions& options);
/// Allows 1e-6 of the diagonal, and other signs where |w| is within 1e-4 of the threshold. Distances to a
/// patch depend on where the winding number crosses the threshold, so less exactly.
void requireSameDistances(const Field& ours, const Field& theirs, const Mesh& mesh,
                          const FieldOptions& options);
/// Compares all arrays and findings of the whole pipeline. Returns the CPU's findings.
Stats compareFields(Backend& backend, const std::string& name, const Mesh& mesh, const GridOptions& grid,
                    const FieldOptions& options);

/// Returns a mesh whose vertices follow up to four of `joints` joints each.
AnimatedMesh wanderers(Mesh rest, uint16_t joints);
/// Moves the vertices; without joints, all of them by the first matrix.
std::vector<glm::vec3> movedVertices(const Probe& probe, const AnimatedMesh& mesh,
                                     const std::vector<JointMatrix>& matrices, bool hasJoints = true);
/// Compares moved vertices.
void compareSkin(const Probe& probe, const AnimatedMesh& mesh, double seconds);
/// Checks that each half float is as near to its value as any.
void requireNearestHalves(std::span<const uint16_t> halves, const Buffer<float>& values);
/// Allows what `RenderOptions::device` says.
void requireSamePicture(const Picture& ours, const Picture& theirs);

}  // namespace raymap::vulkan
