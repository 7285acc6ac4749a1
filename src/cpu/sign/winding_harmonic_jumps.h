#pragma once

#include "cpu/sign/ray_map.h"
#include "method/winding_harmonic_lattices.h"

#include <vector>

namespace raymap::cpu {

/// Right-hand side of the least-squares fit along one axis, kept where it is not zero and sorted by row. At
/// each sample it is the sum of the amounts by which w should exceed its two neighbours along the axis. With
/// Eq. 5, w(i) - w(i + 1) = w_l(i), that is w_l(i) - w_l(i - 1).
class JumpRows {
 public:
  struct Jump {
    int32_t x;
    float height;
  };

  /// Collects the jumps of a lattice. A lattice edge of a coarser level is a chain of finer ones, and its
  /// count is the sum of theirs. So the steps of the same lines serve, with their index shifted.
  void collect(const RayMap& map, const LatticeBox& box, int axis);

  std::span<const Jump> row(size_t row) const {
    return {jumps_.data() + starts_[row], starts_[row + 1] - starts_[row]};
  }
  /// Adds the jumps of a row, times `scale`, to its samples.
  void addTo(float* samples, size_t id, float scale) const {
    for (const Jump& jump : row(id)) samples[jump.x] += scale * jump.height;
  }
  /// Returns about how many bytes the jumps of a lattice take, if this many crossings lie along the axis.
  static size_t bytesNeeded(const LatticeBox& box, size_t crossings) {
    const size_t rows = size_t(box.dims.y) * size_t(box.dims.z), jumps = 2 * crossings >> (2 * box.level);
    return (rows + 2) * sizeof(size_t) + jumps * sizeof(Jump);
  }
  size_t bytes() const { return starts_.capacity() * sizeof(size_t) + jumps_.capacity() * sizeof(Jump); }

 private:
  std::vector<size_t> starts_;
  std::vector<Jump> jumps_;
};

}  // namespace raymap::cpu
