#pragma once

#include <raymap/mesh_view.h>

#include <cstddef>
#include <optional>

namespace raymap {

/// A lattice of samples, which are the centres of cubic cells (Krayer & Müller 2019, §3.5).
///
/// Arrays over a grid are x fastest: sample (i, j, k) has index (k * ny + j) * nx + i.
struct Grid {
  glm::ivec3 dims{0};      ///< Number of samples (nx, ny, nz).
  glm::dvec3 origin{0.0};  ///< Position of sample (0, 0, 0), in the mesh's units.
  double spacing = 0.0;    ///< Distance h between neighbouring samples, in the mesh's units.

  size_t sampleCount() const { return size_t(dims.x) * size_t(dims.y) * size_t(dims.z); }
  size_t index(glm::ivec3 s) const {
    return (size_t(s.z) * size_t(dims.y) + size_t(s.y)) * size_t(dims.x) + size_t(s.x);
  }
  /// Returns the position of sample coordinates, which need not be whole, in the mesh's units.
  glm::dvec3 position(glm::dvec3 s) const { return origin + spacing * s; }
  bool operator==(const Grid&) const = default;
};

inline constexpr int kDefaultResolution = 128;
/// Most samples along a side of a lattice whose samples are not all held: of a narrow band or a region.
inline constexpr int kMostDims = 1 << 24;

/// How to lay a grid over a mesh.
struct GridOptions {
  /// Samples along the longest side of the box; ignored with `voxelSize` or `dims`. By default 128; for a
  /// repair at least 256, chosen by the thinnest part.
  std::optional<int> resolution = {};
  double voxelSize =
      0.0;  ///< Distance between samples, in the mesh's units; 0 = from the resolution or `dims`.
  /// Number of samples (nx, ny, nz), for fields of one shape; by default the box decides. Cells about the
  /// centre of the box are as small as hold it. With `voxelSize` they have that size, and may cut the box.
  std::optional<glm::ivec3> dims = {};
  std::optional<Box> box = {};  ///< Box to cover, in the mesh's units; by default the padded bounds.
  /// Padding of the bounds on every side, as a share of their longest side; ignored with `box`.
  double padding = 0.1;
  double thickness = 0.0;  ///< Thickness of the wall (`FieldOptions`); half of it pads the bounds.
  /// Whether sample (0, 0, 0) lies on multiples of 8 spacings, as OpenVDB's leaves do. Samples of all such
  /// grids of one spacing then coincide, and their level sets can be combined. Excludes `dims`.
  bool align = false;
};

/// Returns the bounds of a mesh that a grid covers: those of all faces that have an area, or of all faces if
/// none has. Ignores indices out of range.
RAYMAP_API Box gridBounds(const MeshView& mesh);

/// Returns the smallest grid of cubic cells that covers the box, or one of `dims` samples about its centre. A
/// side that is not a multiple of the spacing grows by the same length at both ends. With `align` the grid
/// begins at most 8 samples before the box. The bounds of a mesh are its `gridBounds`. Throws `Error(Usage)`
/// if the options make no grid.
RAYMAP_API Grid fitGrid(const MeshView& mesh, const GridOptions& options = {});
/// Does the same for a shape with these bounds, such as those of a mesh in all frames of an animation.
RAYMAP_API Grid fitGrid(const Box& bounds, const GridOptions& options = {});

}  // namespace raymap
