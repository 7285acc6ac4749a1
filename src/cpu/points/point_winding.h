#pragma once

#include <raymap/grid.h>

#include <span>
#include <vector>

#include "cpu/points/segment_crossings.h"
#include "cpu/sign/winding_dipoles.h"
#include "cpu/sign/winding_rims.h"
#include "mesh/packed_mesh.h"
#include "method/turns.h"

namespace raymap::cpu {

/// Winding numbers on a lattice, from which those of points nearby follow. One value per sample.
struct WindingLattice {
  Grid grid;
  Buffer<float> distance;   ///< Unsigned distance to the surface, in cells.
  Buffer<float> winding;    ///< Winding number.
  Buffer<float> agreement;  ///< Confidence in the sign, divided by `marginOf(winding)`.
  /// Whether a rim of the surface is near the cube between a sample and the next ones (`markRims`). Empty if
  /// there are no rims: then all winding numbers are whole.
  Buffer<uint8_t> isNearRim;

  bool isWhole() const { return isNearRim.empty(); }
};

/// Up to so many rims tell the sides of points faster than dipoles do.
inline constexpr size_t kFewRims = 256;

/// Up to so many rims tell the numbers themselves.
inline constexpr size_t kExactRims = 4096;

/// A mesh whose winding number is asked for. Refers to its parts.
struct WindingSource {
  PackedMesh mesh;
  const Turns& turns;             ///< How the sign takes the faces; empty: all as given.
  const SurfaceTree& tree;        ///< The faces as the sign takes them, in the lattice's cells.
  const WindingRims& rims;        ///< Those of the faces as the sign takes them; none if too many.
  const WindingDipoles& dipoles;  ///< Prepared for the tree unless the rims tell all sides.
  const WindingLattice& lattice;
  double threshold = 0.5;
};

/// Points in parallel arrays.
struct WindingPoints {
  std::span<const glm::vec3> cells;   ///< Position in the lattice's cells.
  std::span<const glm::dvec3> exact;  ///< Position relative to the mesh's origin, in the mesh's units.
  std::span<const float> distance;    ///< Unsigned distance to the surface, in cells.
};

/// Computes winding numbers of points. Each thread has its own instance.
class PointWinding {
 public:
  /// Errors allowed in a number itself, and in one of which only the side of the threshold matters.
  static constexpr double kCloseError = 9e-7, kSideError = 1e-3;

  explicit PointWinding(const WindingSource& source);

  /// Computes the numbers well enough to tell on which side of the threshold a point lies: from the nearest
  /// sample and the faces between it and the point where that is enough. Whole numbers are exact.
  void compute(const WindingPoints& points, std::span<double> winding);
  /// Returns how far the number of a point that `compute` was called with may be wrong, 0 to 1; infinite if
  /// only its side is known.
  double doubtOf(size_t point) const;
  /// Computes them to within `allowed`, and exactly near the threshold. With too many rims dipoles compute
  /// them, to about 0.0002 and ever closer towards the threshold.
  void computeClosely(const WindingPoints& points, std::span<double> winding, double allowed = kCloseError);

  /// Returns the confidence in the sign of a point with this winding number.
  float confidence(const glm::vec3& p, double winding) const;

 private:
  static constexpr size_t kCorners = 8;  // of a cell
  /// A sample from which a point's number follows.
  struct Reference {
    static constexpr uint32_t kNone = 0xffffffffu;
    uint32_t sample = kNone;
    bool isVisible = false;  ///< Whether nothing can lie between it and the point.
  };

  size_t nearestSample(const glm::vec3& p) const;
  Reference findReference(const glm::vec3& p, float distance) const;
  glm::vec3 place(uint32_t sample) const;
  bool isOutside(const glm::vec3& p) const;
  bool isNearRim(const glm::vec3& p) const;
  glm::ivec3 lowestCorner(const glm::vec3& p) const;
  float doubtFrom(const glm::vec3& p, float distance) const;
  bool isSettled(double winding, float doubt) const;
  void crossFrom(uint32_t sample, const WindingPoints& points, std::span<const uint32_t> which,
                 std::span<double> winding);
  int32_t crossingsFrom(const glm::vec3& from, const glm::vec3& cells, const glm::dvec3& exactFrom,
                        const glm::dvec3& p);
  RimShare numberFrom(uint32_t sample, const WindingPoints& points, size_t i);
  double exactNumber(const WindingPoints& points, size_t i);
  void settle(const WindingPoints& points, std::span<double> winding);
  double sideOf(const WindingPoints& points, size_t i, double winding);

  WindingSource source_;
  glm::ivec3 dims_;
  float slack_;
  bool isClose_ = false;  ///< Whether the numbers themselves are asked for.
  double allowed_ = kSideError;
  /// Offsets of a cell's corners from its lowest one: x in bit 0, y in bit 1, z in bit 2.
  uint32_t offsets_[kCorners];
  std::vector<uint32_t> asked_, faces_;
  std::vector<uint64_t> crossing_;  // a point below its sample
  std::vector<glm::vec3> ends_;
  std::vector<int32_t> changes_;
  std::vector<float> doubt_;  // how far the number of each point may be wrong, if it is taken from a sample
  std::vector<float> numbers_;
};

}  // namespace raymap::cpu
