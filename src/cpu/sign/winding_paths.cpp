// Krayer & Müller 2019, §3.5, Eq. 9-11: curves through offset points.

#include "cpu/sign/winding_paths.h"

#include <algorithm>
#include <utility>

#include "method/winding_paths_offsets.h"

namespace raymap::cpu {

namespace {

/// Counts the rows walked, once for each offset point.
struct Walked {
  WorkMeter meter;
  size_t rowsPerReport;  ///< About a millisecond of work, for any number of points per row.
};

/// Walks from the samples of a row to their offset points, along the edges of the box between them.
class PathRow {
 public:
  PathRow(const RayMap& map, const std::array<Buffer<int32_t>, 3>& rays, Walked& walked)
      : map_(map),
        rays_(rays),
        walked_(walked),
        from_(size_t(map.dims.x)),
        to_(from_.size()),
        sum_(from_.size()) {}

  /// Returns the total signed crossings of the six paths from each sample of row (j, k) to its offset point.
  const std::vector<int32_t>& countPaths(int j, int k, const glm::ivec3& offset) {
    std::fill(sum_.begin(), sum_.end(), 0);
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side) {
        // The bits of `side` tell whether the axes u and v have been walked before this edge along `axis`.
        // The edge belongs to two of the six paths if it comes first or last, and to one if it comes second.
        const LineAxes across(axis);
        glm::ivec3 start(0);
        start[across.u] = side & 1 ? offset[across.u] : 0;
        start[across.v] = side & 2 ? offset[across.v] : 0;
        glm::ivec3 end = start;
        end[axis] = offset[axis];
        const int32_t paths = side == 0 || side == 3 ? 2 : 1;
        fetch(axis, start.x, j + start.y, k + start.z, from_.data());
        fetch(axis, end.x, j + end.y, k + end.z, to_.data());
        for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += paths * (from_[i] - to_[i]);  // Eq. 6
      }
    if (++unreported_ >= walked_.rowsPerReport) report();
    return sum_;
  }

  void report() { walked_.meter.add(std::exchange(unreported_, 0)); }

 private:
  /// Fetches r along `axis` at the samples (i + shift, j, k) (Eq. 7).
  void fetch(int axis, int shift, int j, int k, int32_t* row) const {
    const glm::ivec3 dims = map_.dims;
    const int begin = std::clamp(-shift, 0, dims.x), end = std::clamp(dims.x - shift, begin, dims.x);
    int32_t before = 0;  // r at samples before the row; only a ray along the row crosses anything
    const bool jInside = j >= 0 && j < dims.y, kInside = k >= 0 && k < dims.z;
    if (jInside && kInside) {
      const size_t first = (size_t(k) * dims.y + j) * dims.x;
      if (axis == 0) before = map_.total(0, first / dims.x);
      const int32_t* rays = rays_[axis].data() + first + shift;
      for (int i = begin; i < end; ++i) row[i] = rays[i];
    } else if ((axis == 1 && j < 0 && kInside) || (axis == 2 && k < 0 && jInside)) {
      const size_t firstLine = size_t(axis == 1 ? k : j) * dims.x;
      for (int i = begin; i < end; ++i) row[i] = map_.total(axis, firstLine + size_t(i + shift));
    } else {
      std::fill(row + begin, row + end, 0);
    }
    std::fill(row, row + begin, before);
    std::fill(row + end, row + dims.x, 0);
  }

  const RayMap& map_;
  const std::array<Buffer<int32_t>, 3>& rays_;
  Walked& walked_;
  uint64_t unreported_ = 0;
  std::vector<int32_t> from_, to_, sum_;
};

/// Fetches the values at the offset points of a row: `values` inside the grid.
class OffsetValues {
 public:
  OffsetValues(const RayMap& map, Sampling sampling, const Buffer<float>& values)
      : map_(map), sampling_(sampling), values_(values), row_(size_t(map.dims.x)) {}

  /// Returns the values of row (j, k). Paper: six rays outside the grid too. Here: 0 there unless asked for,
  /// because a point there is outside the surface: a ray that misses the grid crosses nothing.
  const std::vector<float>& fetch(const glm::ivec3& offset, int j, int k) {
    const glm::ivec3& dims = map_.dims;
    j += offset.y;
    k += offset.z;
    const bool jInside = j >= 0 && j < dims.y, kInside = k >= 0 && k < dims.z;
    const int begin = std::clamp(-offset.x, 0, dims.x), end = std::clamp(dims.x - offset.x, begin, dims.x);
    std::fill(row_.begin(), row_.end(), 0.0f);
    if (jInside && kInside) {
      const size_t line = size_t(k) * dims.y + j;
      for (int i = begin; i < end; ++i) row_[size_t(i)] = values_[line * dims.x + i + offset.x];
      if (sampling_ == Sampling::Spread) return row_;
      std::fill(row_.begin(), row_.begin() + begin, meanRay(0, line, true));
      std::fill(row_.begin() + end, row_.end(), meanRay(0, line, false));
    } else if (sampling_ == Sampling::Paper && jInside != kInside) {
      const int axis = jInside ? 2 : 1;
      const size_t firstLine = size_t(jInside ? j : k) * dims.x;
      for (int i = begin; i < end; ++i)
        row_[size_t(i)] = meanRay(axis, firstLine + size_t(i + offset.x), jInside ? k < 0 : j < 0);
    }
    return row_;
  }

 private:
  /// Returns the mean of the six rays of a point before or beyond a line (Eq. 7). Only the ray along the line
  /// crosses anything. Seen from beyond, each crossing has the other sign.
  float meanRay(int axis, size_t line, bool isBefore) const {
    const int32_t total = map_.total(axis, line);
    return float(isBefore ? total : -total) / float(kRays);
  }

  const RayMap& map_;
  Sampling sampling_;
  const Buffer<float>& values_;
  std::vector<float> row_;
};

void fillRays(const RaySweep& sweep, Walked& walked, std::array<Buffer<int32_t>, 3>& rays) {
  for (Buffer<int32_t>& r : rays) r.resizeUninitialized(sweep.sampleCount());
  sweep.run([&](const RayRow& row) {
    const size_t count = sweep.rowLength();
    std::copy_n(row.x, count, rays[0].data() + row.first);
    std::copy_n(row.y, count, rays[1].data() + row.first);
    std::copy_n(row.z, count, rays[2].data() + row.first);
    if (row.j + 1 == sweep.map().dims.y) walked.meter.add(uint64_t(row.j) + 1);
  });
}

/// Calls `work(paths, j, k, first)` for every row; `first` is the grid index of its first sample.
template <class Work>
void forEachRow(const RayMap& map, const PathScratch& scratch, Walked& walked, Work&& work) {
  parallelFor(size_t(map.dims.z), 4, [&](size_t begin, size_t end) {
    PathRow paths(map, scratch.rays, walked);
    for (int k = int(begin); k < int(end); ++k) {
      for (int j = 0; j < map.dims.y; ++j) work(paths, j, k, (size_t(k) * map.dims.y + j) * map.dims.x);
      paths.report();
    }
  });
}

/// Counts the rows of `points` offset points. The work before them is taken as one more.
Walked walks(const RayMap& map, Progress& progress, double begin, double points) {
  constexpr size_t kSamplesPerReport = size_t{1} << 15;
  return {{progress, begin, 1.0, (points + 1.0) * map.dims.y * map.dims.z},
          std::max<size_t>(1, kSamplesPerReport / size_t(map.dims.x))};
}

}  // namespace

size_t PathScratch::bytes() const {
  return rays[0].capacityBytes() + rays[1].capacityBytes() + rays[2].capacityBytes() + next.capacityBytes();
}

size_t PathScratch::bytesNeeded(size_t samples) {
  return samples * (3 * sizeof(int32_t) + sizeof(float));
}

void averagePaths(const RaySweep& sweep, const FieldOptions& options, Progress& progress, double begin,
                  PathScratch& scratch, Buffer<float>& winding) {
  const RayMap& map = sweep.map();
  const int64_t points = int64_t{options.passes} * pointsPerPass(options);
  Walked walked = walks(map, progress, begin, double(points));
  fillRays(sweep, walked, scratch.rays);
  scratch.next.resizeUninitialized(winding.size());
  const float curves = kRays * (1.0f + kPathsPerPoint * float(points));
  forEachRow(map, scratch, walked, [&](PathRow& paths, int j, int k, size_t first) {
    OffsetValues values(map, options.sampling, winding);
    std::vector<float> sum(sweep.rowLength());
    for (size_t i = 0; i < sum.size(); ++i) sum[i] = kRays * winding[first + i];
    for (int64_t point = 0; point < points; ++point) {
      const glm::ivec3 offset = offsetOf(options, point, map.dims);
      const std::vector<int32_t>& counts = paths.countPaths(j, k, offset);
      const std::vector<float>& there = values.fetch(offset, j, k);
      for (size_t i = 0; i < sum.size(); ++i)  // Eq. 9, summed over the six paths
        sum[i] += kRays * (float(counts[i]) + kPathsPerPoint * there[i]);
    }
    for (size_t i = 0; i < sum.size(); ++i) scratch.next[first + i] = sum[i] / curves;
  });
  winding.swap(scratch.next);
}

void evolvePaths(const RaySweep& sweep, const FieldOptions& options, Progress& progress, double begin,
                 PathScratch& scratch, Buffer<float>& winding) {
  const RayMap& map = sweep.map();
  const int points = pointsPerPass(options);
  Walked walked = walks(map, progress, begin, double(points) * options.passes);
  fillRays(sweep, walked, scratch.rays);
  scratch.next.resizeUninitialized(winding.size());
  for (int step = 0; step < options.passes; ++step) {
    forEachRow(map, scratch, walked, [&](PathRow& paths, int j, int k, size_t first) {
      OffsetValues values(map, options.sampling, winding);
      std::vector<float> sum(winding.data() + first, winding.data() + first + sweep.rowLength());
      for (int point = 0; point < points; ++point) {
        const glm::ivec3 offset = offsetOf(options, int64_t{step} * points + point, map.dims);
        const std::vector<int32_t>& counts = paths.countPaths(j, k, offset);
        const std::vector<float>& there = values.fetch(offset, j, k);
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += float(counts[i]) + kPathsPerPoint * there[i];
      }
      // Eq. 10-11. Paper: counts c and n. Here: w = c / n, because n grows alike at every sample and cancels.
      // Then no count grows with the steps.
      for (size_t i = 0; i < sum.size(); ++i)
        scratch.next[first + i] = sum[i] / float(1 + kPathsPerPoint * points);
    });
    winding.swap(scratch.next);
  }
}

}  // namespace raymap::cpu
