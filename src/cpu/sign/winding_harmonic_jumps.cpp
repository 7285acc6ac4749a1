// Krayer & Müller 2019, §3.5, Eq. 5, as the right-hand side of a least-squares fit.

#include "cpu/sign/winding_harmonic_jumps.h"

#include "base/parallel.h"

namespace raymap::cpu {

namespace {

/// Calls `work(row, jump)` for both ends of each crossing. Lines with different v write to different rows, so
/// v runs in parallel.
template <class Work>
void forEachJump(const RayMap& map, const LatticeBox& box, int axis, Work&& work) {
  const LineAxes across(axis);
  const auto linesAlong = [&](int a) { return ((map.dims[a] - 1) >> box.level) + 1; };
  parallelFor(size_t(linesAlong(across.v)), 4, [&](size_t vBegin, size_t vEnd) {
    for (size_t v = vBegin; v < vEnd; ++v)
      for (int u = 0; u < linesAlong(across.u); ++u) {
        const auto steps =
            map.axes[axis].line((v << box.level) * size_t(map.dims[across.u]) + (size_t(u) << box.level));
        glm::ivec3 sample;
        sample[across.u] = u - box.low[across.u];
        sample[across.v] = int(v) - box.low[across.v];
        for (size_t s = 0; s < steps.size(); ++s) {
          const int32_t height = steps[s].signedSum - (s + 1 < steps.size() ? steps[s + 1].signedSum : 0);
          if (height == 0) continue;
          for (const int end : {0, 1}) {
            sample[axis] = (steps[s].index >> box.level) + end - box.low[axis];
            if (sample[axis] >= 0 && sample[axis] < box.dims[axis])
              work(box.row(sample.y, sample.z),
                   JumpRows::Jump{sample.x, end == 0 ? float(height) : -float(height)});
          }
        }
      }
  });
}

}  // namespace

void JumpRows::collect(const RayMap& map, const LatticeBox& box, int axis) {
  // starts_[row + 2] counts the row's jumps. Then starts_[row + 1] advances from the row's begin to its end.
  starts_.assign(size_t(box.dims.y) * size_t(box.dims.z) + 2, 0);
  forEachJump(map, box, axis, [&](size_t row, const Jump&) { ++starts_[row + 2]; });
  for (size_t row = 2; row < starts_.size(); ++row) starts_[row] += starts_[row - 1];
  jumps_.resize(starts_.back());
  forEachJump(map, box, axis, [&](size_t row, const Jump& jump) { jumps_[starts_[row + 1]++] = jump; });
}

}  // namespace raymap::cpu
