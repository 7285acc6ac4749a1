#pragma once

#include <span>
#include <vector>

#include "base/progress.h"
#include "cpu/points/block_sides.h"

namespace raymap::cpu {

/// Widths of a band around a surface, in the mesh's units. Inside it may be infinite.
struct BandWidths {
  double outside, inside;
};

/// Finds those cubes of a lattice whose samples all lie beyond a band on one side, by the distances of their
/// centres. `Side::Unknown` stands for the others.
class FarCubes {
 public:
  FarCubes(const PreparedSurface& surface, const Grid& lattice, const BandWidths& band)
      : surface_(surface), lattice_(lattice), band_(band) {}

  /// Fills the side of each cube. `cubes` are the first samples of cubes, multiples of their side. Those that
  /// share a cube of twice the side follow each other.
  void find(std::span<const glm::ivec3> cubes, int side, Progress& progress, std::span<Side> sides);

 private:
  void findSome(std::span<const glm::ivec3> cubes, int side, Progress& progress, std::span<Side> sides);
  std::vector<Side> sidesOf(std::span<const glm::ivec3> cubes, int side, std::span<const uint32_t> far);

  const PreparedSurface& surface_;
  const Grid& lattice_;
  BandWidths band_;
  Buffer<glm::dvec3> centres_;
  QueryResult found_;
};

}  // namespace raymap::cpu
