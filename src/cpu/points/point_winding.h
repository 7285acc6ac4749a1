#pragma once

#include <raymap/grid.h>

#include <span>
#include <vector>

#include "cpu/points/segment_crossings.h"
#include "cpu/sign/winding_dipoles.h"
#include "mesh/packed_mesh.h"
#include "method/turns.h"

namespace raymap::cpu {

/// Winding numbers on a lattice, from which those of points nearby follow. One value per sample.
struct WindingLattice {
  Grid grid;
  Buffer<float> distance;    ///< Unsigned distance to the surface, in cells.
  Buffer<float> winding;     ///< Winding number.
  Buffer<float> confidence;  ///< Confidence in the sign.
  /// Whether a rim of the surface is near the cube between a sample and the next ones (`markRims`). Empty if
  /// there are no rims: then all winding numbers are whole.
  Buffer<uint8_t> isNearRim;

  bool isWhole() const { return isNearRim.empty(); }
};

/// A mesh whose winding number is asked for. Refers to its parts.
struct WindingSource {
  PackedMesh mesh;
  const Turns& turns;             ///< How the sign takes the faces; empty: all as given.
  const SurfaceTree& tree;        ///< The faces as the sign takes them, in the lattice's cells.
  const WindingDipoles& dipoles;  ///< Prepared for the tree.
  const WindingLattice& lattice;
  double threshold = 0.5;
};

/// Points in parallel arrays.
struct WindingPoints {
  std::span<const glm::vec3> cells;   ///< Position in the lattice's cells.
  std::span<const glm::dvec3> exact;  ///< Position relative to the mesh's origin, in the mesh's units.
  std::span<const float> distance;    ///< Unsigned distance to the surface, in cells.
};

/// Computes winding numbers of points. A number is exact if the lattice's are whole. Else it is good enough
/// to tell on which side of the threshold the point lies. Each thread has its own instance.
class PointWinding {
 public:
  explicit PointWinding(const WindingSource& source);

  /// Computes the numbers, from the nearest sample and the faces between it and the point where that is
  /// enough.
  void compute(const WindingPoints& points, std::span<float> winding);
  /// Computes them from the faces themselves, to about 0.0002 and ever closer towards the threshold, unless
  /// the lattice's are whole.
  void computeClosely(const WindingPoints& points, std::span<float> winding);

  /// Returns the index of the sample closest to a point.
  size_t nearestSample(const glm::vec3& p) const;

 private:
  static constexpr size_t kCorners = 8;  // of a cell

  /// A sample from which a point's number follows.
  struct Reference {
    static constexpr uint32_t kNone = 0xffffffffu;
    uint32_t sample = kNone;
    bool isVisible = false;  ///< Whether nothing can lie between it and the point.
  };

  Reference findReference(const glm::vec3& p, float distance) const;
  glm::vec3 place(uint32_t sample) const;
  bool isOutside(const glm::vec3& p) const;
  bool isNearRim(const glm::vec3& p) const;
  bool isSettled(float winding, float distance) const;
  bool mayCrossExactly(const glm::vec3& p, float distance) const;
  void crossFrom(uint32_t sample, const WindingPoints& points, std::span<const uint32_t> which,
                 std::span<float> winding);
  bool crossExactly(const glm::dvec3& p, const glm::vec3& cells, float& winding);

  WindingSource source_;
  glm::ivec3 dims_;
  float slack_;
  /// Offsets of a cell's corners from its lowest one: x in bit 0, y in bit 1, z in bit 2.
  uint32_t offsets_[kCorners];
  std::vector<uint32_t> asked_, faces_;
  std::vector<uint64_t> crossing_;  // a point below its sample
  std::vector<glm::vec3> ends_;
  std::vector<int32_t> changes_;
  std::vector<float> numbers_;
};

}  // namespace raymap::cpu
