#include <raymap/mesh_thickness.h>
#include <raymap/repair.h>
#include <raymap/words.h>

#include <algorithm>
#include <cmath>

#include "base/memory.h"
#include "base/require.h"
#include "base/text.h"
#include "measure/thinnest.h"
#include "mesh/model.h"
#include "repair/stages.h"
#include "simplify/face_point_lists.h"

namespace raymap {

namespace {

// Samples along the longest side of a soup of faces. Its surface is mostly what closes the gaps.
constexpr int kSoupResolution = 128;
// Memory of a repair, which is at most about this much, of each cube if not all samples are needed.
constexpr size_t kBytesPerCube = 1024;
// An isosurface with more samples along a side loses the precision of its vertices.
constexpr int kMostAlongSide = 1 << 14;

/// Returns the bounds of a mesh, extended to the base that it is joined to.
Box boundsWithBase(const MeshView& mesh, const RepairOptions& repair) {
  Box box = bounds(mesh);
  if (!repair.base || box.isEmpty()) return box;
  require(glm::length(repair.down) > 0.0, "the way down must not be zero");
  const glm::dvec3 up = -repair.down / glm::length(repair.down), low = box.min, high = box.max;
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    p += (*repair.base - glm::dot(p, up)) * up;
    box.min = glm::min(box.min, p), box.max = glm::max(box.max, p);
  }
  return box;
}

GridOptions coveringOptions(const GridOptions& options, const RepairOptions& repair) {
  GridOptions covering = options;
  covering.resolution = options.resolution.value_or(kRepairResolution);
  covering.box.reset();
  covering.dims.reset();
  covering.thickness = std::max({2.0 * repair.offset, repair.minThickness.value_or(0.0), 0.0});
  return covering;
}

/// Returns the number of samples along the longest side of a grid.
std::string samplesAlong(const Grid& grid) {
  return std::to_string(std::max({grid.dims.x, grid.dims.y, grid.dims.z})) + " samples";
}

/// Returns about how many samples a grid that covers a box by default has along each side.
glm::dvec3 samplesFor(const Box& box, double voxelSize) {
  const glm::dvec3 size = box.size();
  const double padding = 2.0 * GridOptions{}.padding * std::max({size.x, size.y, size.z});
  return (size + padding) / voxelSize;
}

/// Returns the largest voxel size for the walls and drain holes of a hollow; infinite for no shell.
double voxelSizeOf(const RepairOptions& repair) {
  if (repair.shell <= 0.0) return INFINITY;
  return 0.5 * (repair.drainHole > 0.0 ? std::min(repair.shell, repair.drainHole) : repair.shell);
}

/// Returns how many cubes one at the surface stands for: a hollow has two surfaces, and samples in its walls.
double cubesFor(const RepairOptions& repair, double voxelSize) {
  constexpr double kSamplesOfCube = 128.0;  // They take the time of a cube.
  const double deep = repair.shell + 0.5 * repair.drainHole;
  return repair.shell > 0.0 ? 2.0 + deep / (kSamplesOfCube * voxelSize) : 1.0;
}

bool isChosen(const GridOptions& options) {
  return options.resolution || options.voxelSize > 0.0;
}

}  // namespace

bool needsAllSamples(const MachineOptions& machine) {
  return machine.device.starts_with("vulkan");
}

double surfaceCubes(const MeshView& mesh, double spacing) {
  return sumFaces(Model(mesh)).area / (spacing * spacing);
}

RepairGrid chooseRepairGrid(const MeshView& mesh, const Verdict& verdict, const GridOptions& options,
                            const RepairOptions& repair, const MachineOptions& machine) {
  GridOptions covering = coveringOptions(options, repair);
  const bool isSoup = verdict.kind == MeshKind::Soup;
  if (!isChosen(options) && isSoup) covering.resolution = kSoupResolution;
  const Box box = boundsWithBase(mesh, repair);
  const auto fit = [&] { return box.isEmpty() ? fitGrid(mesh, covering) : fitGrid(box, covering); };
  RepairGrid grid{fit()};
  grid.surfaceCubes = surfaceCubes(mesh, grid.spacing);
  const double walls = voxelSizeOf(repair);
  const double voxelSize = std::min(verdict.voxelSize.value_or(INFINITY), walls);
  if (isChosen(options) || isSoup || voxelSize >= grid.spacing) return grid;
  grid.thinnest = voxelSize == walls ? 2.0 * walls : std::max(*verdict.thinnest, 2.0 * voxelSize);
  covering.voxelSize = voxelSize;
  const double finer = grid.spacing / covering.voxelSize, cubes = finer * finer * grid.surfaceCubes;
  const double samples = finer * finer * finer * double(grid.sampleCount());
  const size_t memory = machine.memoryLimit > 0 ? mostMemory(machine.memoryLimit) : SIZE_MAX;
  const bool areFew =
      needsAllSamples(machine)
          ? samples <= double(std::min(memory / kBytesPerSample, kMostRepairSamples))
          : cubes * cubesFor(repair, covering.voxelSize) <=
                    double(std::min(memory / kBytesPerCube, kMostRepairCubes)) &&
                finer * std::max({grid.dims.x, grid.dims.y, grid.dims.z}) <= double(kMostAlongSide);
  if (!areFew && verdict.voxelSize && repair.shell > 0.0)
    static_cast<Grid&>(grid) = chooseRepairGrid(mesh, {}, options, repair, machine);  // For the walls alone.
  if (!areFew) return grid;
  static_cast<Grid&>(grid) = fit();
  grid.surfaceCubes = cubes;
  return grid;
}

RepairGrid fitRepairGrid(const MeshView& mesh, const GridOptions& options, const RepairOptions& repair,
                         const MachineOptions& machine) {
  Verdict verdict;
  if (!isChosen(options) && mesh.triangleCount > 0) {
    const Diagnostics found = diagnose(mesh, {}, machine);
    verdict = judge(found, {});
    addThinnest(mesh, found, machine, verdict);
  }
  return chooseRepairGrid(mesh, verdict, options, repair, machine);
}

std::string describeThickness(const MeshView& mesh, const Verdict& verdict, const MachineOptions& machine) {
  if (verdict.sought == 0.0)
    return hasThickness(verdict) ? "The thickness was not measured: there are too many triangles." : "";
  const RepairGrid grid = chooseRepairGrid(mesh, verdict, {}, {}, machine);
  if (!verdict.voxelSize)
    return "No part is thinner than " + rounded(verdict.sought) + "; a repair with " + samplesAlong(grid) +
           " keeps all.";
  const std::string part = "Its thinnest part is about " + rounded(*verdict.thinnest) + " thick. ";
  const std::string voxels = "a voxel size of " + numberText(*verdict.voxelSize, 3);
  if (!grid.thinnest && *verdict.voxelSize >= grid.spacing)
    return part + "A repair with " + samplesAlong(grid) + " keeps it; so does " + voxels + ".";
  const bool isKept = grid.thinnest && grid.keepsThinnest();
  const glm::dvec3 n =
      isKept ? glm::dvec3(grid.dims) : glm::ceil(samplesFor(bounds(mesh), *verdict.voxelSize));
  const std::string samples =
      voxels + ": " + rounded(n.x) + " x " + rounded(n.y) + " x " + rounded(n.z) + " samples";
  if (isKept) return part + "A repair chooses what keeps it, " + samples + ".";
  return part + "To keep it as it is would take " + samples + ". A repair that must make new faces takes " +
         samplesAlong(grid) + ", and makes what is thinner " + rounded(kThinnestWall * grid.spacing) +
         " thick.";
}

}  // namespace raymap
