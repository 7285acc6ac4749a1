#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <optional>

namespace raymap {

/// A lattice of samples: `dims = (nx, ny, nz)` cell centres, `origin` = position of sample (0,0,0), one cubic
/// `spacing` h (Krayer & Müller 2019, §3.5). x is fastest in memory: index = (k*ny + j)*nx + i.
struct Grid {
  glm::ivec3 dims{0};
  glm::dvec3 origin{0.0};
  double spacing = 0.0;

  size_t sampleCount() const { return size_t(dims.x) * size_t(dims.y) * size_t(dims.z); }
  size_t index(glm::ivec3 s) const { return (size_t(s.z) * dims.y + s.y) * dims.x + s.x; }
  glm::dvec3 position(glm::dvec3 s) const { return origin + spacing * s; }
  bool operator==(const Grid&) const = default;
};

/// How to lay a grid over a mesh.
struct GridOptions {
  int resolution = 128;    ///< Samples along the longest side of the box; ignored if voxelSize is set.
  double voxelSize = 0.0;  ///< Spacing in the mesh's units; 0 = from the resolution.
  std::optional<Box> box;  ///< The box to cover; by default the mesh's bounds, padded.
  double padding = 0.1;    ///< Padding on every side, as a share of the longest side of the mesh's bounds.
};

/// The smallest grid of cubic cells that covers the box; a side that is no multiple of the spacing grows
/// evenly at both ends. Throws `Error(Usage)` if the options make no grid.
Grid fitGrid(const Mesh& mesh, const GridOptions& options = {});

}  // namespace raymap
