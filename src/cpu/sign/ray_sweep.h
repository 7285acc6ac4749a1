#pragma once

#include "base/parallel.h"
#include "cpu/sign/ray_map.h"

#include <vector>

namespace raymap::cpu {

/// Rays of one row of samples (j, k), x running, as in Eq. 7.
struct RayRow {
  int j, k;
  size_t first;                    ///< Grid index of the row's first sample.
  const int32_t *x, *y, *z;        ///< r along the three axes.
  int32_t totalX;                  ///< Total of the line along x: r from before its first sample.
  const int32_t *totalY, *totalZ;  ///< Totals of the lines along y and z through each sample.
};

/// Streams the dense grid of r that a ray map stands for, row by row, without storing it.
class RaySweep {
 public:
  explicit RaySweep(const RayMap& map);

  const RayMap& map() const { return map_; }
  size_t rowLength() const { return size_t(map_.dims.x); }
  size_t sampleCount() const { return size_t(map_.dims.x) * size_t(map_.dims.y) * size_t(map_.dims.z); }

  /// Calls `work(const RayRow&)` for all rows. Slabs of planes run in parallel, each slab in order.
  template <class Work>
  void run(Work&& work) const;

 private:
  /// Change of r by `delta` at sample x of a row, against the previous sample along the axis.
  struct Change {
    int32_t x;
    int32_t delta;
  };
  /// Changes along y or z, sorted by the row in which they take effect.
  struct Changes {
    std::vector<uint32_t> starts;
    std::vector<Change> changes;
  };
  /// Values of r in one slab.
  struct State {
    std::vector<int32_t> x, y, totalY, z;
  };

  static Changes collectChanges(const RayMap& map, int axis);
  void startSlab(int k, State& state) const;
  void startPlane(int k, State& state) const;
  RayRow advanceRow(int j, int k, State& state) const;

  const RayMap& map_;
  std::array<Changes, 2> changes_;  // along y and z
  std::vector<int32_t> totalZ_;
};

template <class Work>
void RaySweep::run(Work&& work) const {
  constexpr size_t kPlanesPerSlab = 16;  // a slab starts with one look-up per line along z
  parallelFor(size_t(map_.dims.z), kPlanesPerSlab, [&](size_t begin, size_t end) {
    State state;
    startSlab(int(begin), state);
    for (int k = int(begin); k < int(end); ++k) {
      startPlane(k, state);
      for (int j = 0; j < map_.dims.y; ++j) work(advanceRow(j, k, state));
    }
  });
}

}  // namespace raymap::cpu
