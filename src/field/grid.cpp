#include <raymap/error.h>
#include <raymap/grid.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/require.h"
#include "base/text.h"
#include "mesh/area_bounds.h"

namespace raymap {

namespace {

constexpr int kMaxDim = 1 << 20;

double longestSide(glm::dvec3 size) {
  return std::max({size.x, size.y, size.z});
}

void check(const GridOptions& options) {
  const int resolution = options.resolution.value_or(kDefaultResolution);
  require(options.voxelSize != 0.0 || options.dims || resolution >= 1,
          "the resolution must be at least 1, not " + std::to_string(resolution));
  require(options.voxelSize >= 0.0 && std::isfinite(options.voxelSize),
          "the voxel size must be positive, not " + numberText(options.voxelSize));
  if (const auto dims = options.dims)
    require(glm::all(glm::greaterThan(*dims, glm::ivec3(0))),
            "the grid must have at least 1 sample along every side, not " + std::to_string(dims->x) + " x " +
                std::to_string(dims->y) + " x " + std::to_string(dims->z));
  require(options.padding >= 0.0 && std::isfinite(options.padding),
          "the padding must not be negative, not " + numberText(options.padding));
  require(!options.align || !options.dims,
          "samples about the centre of the box cannot be aligned; leave out their number");
  require(options.thickness >= 0.0 && std::isfinite(options.thickness),
          "the thickness must not be negative, not " + numberText(options.thickness));
}

/// Returns by how much bounds are padded on every side.
double paddingOf(const Box& bounds, const GridOptions& options) {
  const double longest = longestSide(bounds.size());
  return options.padding * (longest > 0.0 ? longest : 1.0) + 0.5 * options.thickness;
}

/// Throws `Error(Usage)` unless the sides of a box are finite.
void check(const Box& box) {
  const glm::dvec3 size = box.size();
  for (int a = 0; a < 3; ++a)
    require(std::isfinite(size[a]), std::string("the box reaches from ") + "xyz"[a] + " = " +
                                        numberText(box.min[a]) + " to " + numberText(box.max[a]) +
                                        "; both must be finite, and so must their difference");
}

int samplesAlong(double length, double spacing) {
  // A side that is a multiple of the spacing up to rounding must not gain a sample.
  const double count = std::max(1.0, std::ceil(length / spacing * (1.0 - 1e-12) - 1e-9));
  require(count <= kMaxDim, "a side of " + numberText(length) + " at a spacing of " + numberText(spacing) +
                                " needs more than " + std::to_string(kMaxDim) +
                                " samples; use a larger voxel size");
  return static_cast<int>(count);
}

/// Lays an axis of a grid so that its first sample lies on a multiple of 8 spacings.
void align(const Box& box, int axis, Grid& grid) {
  constexpr double kLeafSide = 8.0, kMostSteps = 1e9;
  const double h = grid.spacing, low = box.min[axis] / h, high = box.max[axis] / h;
  require(std::abs(low) < kMostSteps && std::abs(high) < kMostSteps,
          "the box lies so many spacings of " + numberText(h) + " from 0 that samples cannot be aligned; " +
              "use a larger voxel size, or move the mesh");
  // A cell reaches half a spacing beyond its sample. A side on the rim of a cell needs no further one.
  constexpr double kRounding = 1e-6;
  const double first = kLeafSide * std::floor(std::floor(low + 0.5 + kRounding) / kLeafSide);
  grid.dims[axis] = samplesAlong(std::max(1.0, std::ceil(high - 0.5 - kRounding) - first + 1.0), 1.0);
  grid.origin[axis] = h * first;
}

}  // namespace

Box gridBounds(const MeshView& mesh) {
  const Box box = areaBounds(mesh);
  return box.isEmpty() ? bounds(mesh) : box;
}

Grid fitGrid(const MeshView& mesh, const GridOptions& options) {
  if (!options.box && mesh.triangleCount == 0)
    throw Error(ErrorCode::Input, "the mesh has no triangles, so it has no bounds; give a box to cover");
  return fitGrid(options.box ? Box{} : gridBounds(mesh), options);
}

Grid fitGrid(const Box& bounds, const GridOptions& options) {
  check(options);
  const Box box = options.box.value_or(bounds);
  const double pad = options.box ? 0.0 : paddingOf(box, options);
  const Box covered{box.min - pad, box.max + pad};
  check(covered);
  // Given dims are laid about the box itself, without the rounding of the padded corners.
  const glm::dvec3 size = options.dims ? box.size() + 2.0 * pad : covered.size();
  const glm::dvec3 centre = (options.dims ? box : covered).centre();
  const glm::ivec3 counts =
      options.dims.value_or(glm::ivec3(options.resolution.value_or(kDefaultResolution)));
  Grid grid;
  grid.spacing = options.voxelSize > 0.0 ? options.voxelSize : longestSide(size / glm::dvec3(counts));
  require(!covered.isEmpty() && grid.spacing > 0.0, "the box is empty: its maximum must exceed its minimum");
  if (options.align) {
    for (int a = 0; a < 3; ++a) align(covered, a, grid);
    return grid;
  }
  for (int a = 0; a < 3; ++a) grid.dims[a] = options.dims ? counts[a] : samplesAlong(size[a], grid.spacing);
  grid.origin = centre - 0.5 * grid.spacing * glm::dvec3(grid.dims - 1);
  return grid;
}

}  // namespace raymap
