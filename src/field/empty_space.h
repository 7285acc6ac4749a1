#pragma once

#include <raymap/narrow_band.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace raymap {

/// A box of samples.
struct SampleBox {
  glm::ivec3 first, last;
};

/// A coarse map of what lies far from a narrow band's leaves and tiles. The lattice is cut into cubes of
/// samples, at most 128 along each axis.
class EmptySpace {
 public:
  /// The band must be valid.
  explicit EmptySpace(const Field& band);

  /// Returns a box around a sample on the lattice without leaves and tiles: all its samples are outside. None
  /// near leaves and tiles. The box may reach beyond the lattice.
  std::optional<SampleBox> boxAround(const glm::ivec3& sample) const;

  int bits() const { return bits_; }                ///< A cube has 2^bits samples along its side.
  const glm::ivec3& dims() const { return dims_; }  ///< Number of cubes.
  /// Number of cubes from each cube, x fastest, to the closest one with leaves or tiles, along the axis on
  /// which it is farthest. 0 for that one.
  const std::vector<uint8_t>& away() const { return away_; }

 private:
  static constexpr int kMostCubes = 128;

  size_t index(const glm::ivec3& cube) const {
    return (size_t(cube.z) * size_t(dims_.y) + size_t(cube.y)) * size_t(dims_.x) + size_t(cube.x);
  }
  void markFilled(const glm::ivec3& first, const glm::ivec3& last);
  void measure();

  int bits_;
  glm::ivec3 dims_;
  std::vector<uint8_t> away_;
};

}  // namespace raymap
