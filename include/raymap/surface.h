#pragma once

#include <raymap/export.h>
#include <raymap/generate.h>
#include <raymap/local_thickness.h>
#include <raymap/machine.h>
#include <raymap/narrow_band.h>
#include <raymap/query.h>
#include <raymap/region.h>
#include <raymap/surface_pair.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace raymap {

class Progress;

/// A mesh prepared once for queries at any points. It has a mesh of its own and never changes, so several
/// threads may use it at the same time.
///
/// Distances are those to the mesh itself, within a millionth of its diagonal. (Farther from the mesh than
/// its size, they are within a millionth of the distance.) Signs follow the winding number, as those of
/// `generate`. The results of a point depend neither on the other points of the call, nor on their order, nor
/// on the number of threads.
class RAYMAP_API Surface {
 public:
  /// Prepares a mesh on the CPU. `machine.threads`, `memoryLimit` and `progress` are used. Throws `Error`:
  /// Input (see `validate`), Usage for the options, Memory, Cancelled.
  explicit Surface(const MeshView& mesh, const SurfaceOptions& options = {},
                   const MachineOptions& machine = {});
  /// Does the same, and keeps the mesh instead of a copy.
  explicit Surface(Mesh&& mesh, const SurfaceOptions& options = {}, const MachineOptions& machine = {});
  ~Surface();
  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;

  /// Returns what is asked for at the points. `machine.threads` and `progress` are used. Throws `Error`:
  /// Usage for options that make no sense, Memory, Cancelled.
  QueryResult query(const PointsView& points, const QueryOptions& options = {},
                    const MachineOptions& machine = {}) const;
  /// Does the same, reusing the memory of `result`. After an error its contents are undefined.
  void query(const PointsView& points, const QueryOptions& options, QueryResult& result,
             const MachineOptions& machine = {}) const;

  /// Returns a field of the mesh. Its faces are turned and left out as the surface found best, whatever
  /// `options.orientation` says. Uses `machine` and throws as `raymap::generate` does.
  Generated generate(const Grid& grid, const FieldOptions& options = {},
                     const MachineOptions& machine = {}) const;

  /// Returns the field near the surface alone, on a lattice of up to 2^24 samples a side. A sample's values
  /// are those of `query` at its position, rounded to `float`, however the lattice lies around it.
  /// `machine.threads`, `memoryLimit`, `warn` and `progress` are used. Throws `Error`: Usage for a grid or
  /// options that make no sense, Memory, Cancelled.
  Field generateBand(const Grid& grid, const BandOptions& options = {},
                     const MachineOptions& machine = {}) const;

  /// Returns the field of a region of a lattice of up to 2^24 samples a side. A sample's values are those of
  /// `query` at its position on the lattice, `lattice.position(sample)`, rounded to `float`, however the
  /// lattice is cut into regions. With a band, the distances are clamped after that. The field's grid has the
  /// position of the region's first sample as its origin, so positions on it may differ from those on the
  /// lattice in the last bits. `machine.threads`, `memoryLimit`, `warn` and `progress` are used. Throws
  /// `Error`: Usage for a region that does not lie on the lattice, for a lattice or options that make no
  /// sense, Memory, Cancelled.
  Field generateRegion(const Grid& lattice, const Region& region, const RegionOptions& options = {},
                       const MachineOptions& machine = {}) const;
  /// Returns the distance that all samples of a region have in its field if they lie beyond the band on one
  /// side: `options.band` samples, negative inside. Takes a few queries at most, so that huge lattices can be
  /// passed over quickly. Nothing: some samples may lie in the band or on the other side, or there is no
  /// band. Throws `Error(Usage)` as `generateRegion` does.
  std::optional<double> farDistance(const Grid& lattice, const Region& region,
                                    const RegionOptions& options) const;
  /// Returns the bytes that the surface holds, and `regionBytes` of a region.
  size_t regionBytes(const glm::ivec3& size, const RegionOptions& options = {},
                     const MachineOptions& machine = {}) const;

  /// Returns whether the surface tells inside from outside.
  bool isSigned() const;
  /// Returns the mesh as the surface keeps it: positions in single precision about an origin.
  MeshView mesh() const;
  /// Returns the bytes that the surface holds.
  size_t bytes() const;
  /// Returns what it cost to prepare the mesh, and what was found out about it.
  const Stats& stats() const;

  /// Returns the thickness of the mesh at points of its faces. `machine.threads` and `progress` are used.
  /// Throws `Error`: Usage for options that make no sense, for a face that does not exist and without a sign;
  /// Memory, Cancelled.
  std::vector<Thickness> thickness(std::span<const FacePoint> points, const ThicknessOptions& options = {},
                                   const MachineOptions& machine = {}) const;

  /// Returns the points of this surface and of another one that are least apart, in this one's coordinates:
  /// 0 apart where faces cross. Only the faces count. Exact in double precision. Runs on one thread.
  /// `machine.progress` is used. Throws `Error`: Usage, if `maxDistance` is not above 0 or the pose is no
  /// rigid motion; Cancelled.
  SurfacePair distanceTo(const Surface& other, const PairOptions& options = {},
                         const MachineOptions& machine = {}) const;
  /// Returns the point that is farthest from the other surface, the point of that which is closest to it, and
  /// their distance as `query` measures it, in this one's coordinates: the Hausdorff distance. No other point
  /// is farther than `bound`, which exceeds the distance by at most the tolerance, unless the search would
  /// divide the faces into more than 2^24 parts. `machine.threads` and `progress` are used. Throws `Error`:
  /// Usage, if the tolerance is negative or the pose is no scaled rigid motion; Memory, Cancelled.
  SurfacePair hausdorff(const Surface& other, const HausdorffOptions& options = {},
                        const MachineOptions& machine = {}) const;
  /// Returns the point that is deepest inside, of some: how far they penetrate the mesh. Uses `machine` and
  /// throws as `query` does, and `Error(Usage)` for a surface without a sign.
  DeepestPoint deepest(const PointsView& points, const MachineOptions& machine = {}) const;

 private:
  friend class Scene;

  /// Returns how far from the bounds of the mesh a point may still be inside: 0 for a mesh without boundary
  /// edges, and without a sign. A point that is farther away is outside.
  double insideReach() const;
  /// Does what `distanceTo` does, without a check.
  SurfacePair closestPair(const Surface& other, const PairOptions& options, Progress& progress) const;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the most bytes that a region of this size holds while a surface makes it, besides the surface.
/// `machine.threads` is used. Throws `Error(Usage)` for a size without samples.
RAYMAP_API size_t regionBytes(const glm::ivec3& size, const RegionOptions& options = {},
                              const MachineOptions& machine = {});

/// Returns whether a compact surface is the better one to make a band on this grid of a mesh with so many
/// triangles (`SurfaceOptions::compact`). With more samples per triangle, the band takes most of the memory
/// anyway.
RAYMAP_API bool isCompactBetter(const Grid& grid, size_t triangles);

}  // namespace raymap
