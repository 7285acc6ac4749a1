#include <raymap/error.h>
#include <raymap/grid.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/text.h"

namespace raymap {

namespace {

constexpr int kMaxDim = 1 << 20;

Box padded(Box box, const GridOptions& options) {
  const glm::dvec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  const double pad = options.padding * (longest > 0.0 ? longest : 1.0) + 0.5 * options.thickness;
  box.min -= pad;
  box.max += pad;
  return box;
}

int samplesAlong(double length, double spacing) {
  // A side that is a multiple of the spacing up to rounding must not gain a sample.
  const double count = std::max(1.0, std::ceil(length / spacing * (1.0 - 1e-12) - 1e-9));
  if (!(count <= kMaxDim))
    throw Error(ErrorCode::Usage, "a side of " + numberText(length) + " at a spacing of " +
                                      numberText(spacing) + " needs more than " + std::to_string(kMaxDim) +
                                      " samples; use a larger voxel size");
  return static_cast<int>(count);
}

}  // namespace

Grid fitGrid(const MeshView& mesh, const GridOptions& options) {
  if (!options.box && mesh.triangleCount == 0)
    throw Error(ErrorCode::Input, "the mesh has no triangles, so it has no bounds; give a box to cover");
  return fitGrid(options.box ? Box{} : bounds(mesh), options);
}

Grid fitGrid(const Box& bounds, const GridOptions& options) {
  const int resolution = options.resolution.value_or(kDefaultResolution);
  if (options.voxelSize == 0.0 && resolution < 1)
    throw Error(ErrorCode::Usage, "the resolution must be at least 1, not " + std::to_string(resolution));
  if (!(options.voxelSize >= 0.0) || !std::isfinite(options.voxelSize))
    throw Error(ErrorCode::Usage, "the voxel size must be positive, not " + numberText(options.voxelSize));
  if (!(options.padding >= 0.0) || !std::isfinite(options.padding))
    throw Error(ErrorCode::Usage, "the padding must not be negative, not " + numberText(options.padding));
  if (!(options.thickness >= 0.0) || !std::isfinite(options.thickness))
    throw Error(ErrorCode::Usage, "the thickness must not be negative, not " + numberText(options.thickness));
  const Box box = options.box ? *options.box : padded(bounds, options);
  const glm::dvec3 size = box.size();
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(size[a]))
      throw Error(ErrorCode::Usage, std::string("the box reaches from ") + "xyz"[a] + " = " +
                                        numberText(box.min[a]) + " to " + numberText(box.max[a]) +
                                        "; both must be finite, and so must their difference");
  const double longest = std::max({size.x, size.y, size.z});
  if (box.isEmpty() || longest == 0.0)
    throw Error(ErrorCode::Usage, "the box is empty: its maximum must exceed its minimum");
  Grid grid;
  grid.spacing = options.voxelSize > 0.0 ? options.voxelSize : longest / resolution;
  for (int a = 0; a < 3; ++a) grid.dims[a] = samplesAlong(size[a], grid.spacing);
  grid.origin = box.centre() - 0.5 * grid.spacing * glm::dvec3(grid.dims - 1);
  return grid;
}

}  // namespace raymap
