// Krayer & Müller 2019, §3.3, Algorithms 1 and 2.
//
// Paper: one line per work item, in shared memory; the longer the lines, the fewer are in flight. Here: lines
// adjacent along x go through a small tile of whole cache lines, because the memory throughput is then the
// same along x, y and z. Along x no envelope is needed: triangles touch the cells that list them, so no value
// before this pass exceeds 3/4, and the nearest occupied cell on each side is the lowest there.

#include "cpu/cells/distance_transform.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "cpu/cells/cell_distance.h"

namespace raymap::cpu {

namespace {

// Two cache lines of floats; processors fetch cache lines in pairs.
constexpr int kLanes = 32;

/// Lower envelope, at whole p, of the parabolas (p - q)^2 + f(q) of one line's occupied cells.
class Envelope {
 public:
  explicit Envelope(int length) : length_(length), parabolas_(length), halfInverse_(length) {
    for (int d = 1; d < length; ++d) halfInverse_[d] = 0.5 / d;
  }
  void clear() { count_ = 0; }

  /// Adds a parabola (Algorithm 2, lines 28-44); q must ascend. Paper: borders between parabolas are real
  /// numbers. Here: a border is the last whole p before it, found exactly, because ties are common and must
  /// go to the lower q. A parabola is dropped if no whole p is left to it.
  void push(int q, float value, uint32_t cell) {
    int from = 0;
    while (count_ > 0) {
      const Parabola& top = parabolas_[count_ - 1];
      from = lastOf(top, q, value) + 1;
      if (from > top.from) break;
      --count_;
      from = 0;
    }
    if (from < length_) parabolas_[count_++] = {from, q, value, cell};
  }

  /// Calls write(p, squared, cell) for each p of the line (lines 45-54). Of equal values the lower q wins.
  template <class Write>
  void sample(Write&& write) const {
    int p = 0;
    for (int k = 0; k < count_; ++k) {
      const Parabola& parabola = parabolas_[k];
      const int end = k + 1 < count_ ? parabolas_[k + 1].from : length_;
      for (; p < end; ++p) {
        const auto d = static_cast<float>(p - parabola.q);
        write(p, d * d + parabola.value, parabola.cell);
      }
    }
  }

 private:
  struct Parabola {
    int from;  ///< First p at which this parabola is the lowest.
    int q;
    float value;
    uint32_t cell;
  };

  /// Returns the last p, at least -1, at which `a` is no higher than the parabola of q > a.q.
  int lastOf(const Parabola& a, int q, float value) const {
    constexpr double kDoubt = 1e-6;  // Larger than the rounding error of a border.
    const double difference = double(value) - double(a.value);
    const double border = difference * halfInverse_[q - a.q] + 0.5 * (a.q + q);
    const double clamped = std::min(std::max(border, -0.5), double(length_)) + kDoubt;
    const int p = static_cast<int>(clamped + 1.0) - 1;
    return clamped - p > 2.0 * kDoubt || isNoHigher(a, q, value, p) ? p : p - 1;
  }

  static bool isNoHigher(const Parabola& a, int q, float value, int p) {
    const double asked = double(q - a.q) * (2.0 * p - a.q - q);
    const double high = value, low = a.value, difference = high - low;
    if (difference != asked) return difference > asked;
    const double taken = difference - high;  // For the exact rounding error of `difference` (Knuth 1969).
    return (high - (difference - taken)) - (low + taken) >= 0.0;
  }

  int length_;
  std::vector<Parabola> parabolas_;
  std::vector<double> halfInverse_;
  int count_ = 0;
};

class Transform {
 public:
  Transform(glm::ivec3 dims, Progress& progress, Buffer<float>& squared, Buffer<uint32_t>& cells)
      : dims_(dims), empty_(emptyCell(dims)), progress_(progress), squared_(squared), cells_(cells) {}

  void alongX() {
    const size_t lines = size_t(dims_.y) * dims_.z;
    parallelFor(lines, std::max<size_t>(1, (size_t{1} << 16) / dims_.x), [&](size_t begin, size_t end) {
      progress_.report(double(begin) / double(lines) / 3.0);
      Row row(dims_.x);
      for (size_t line = begin; line < end; ++line) transformRow(row, line * dims_.x);
    });
  }

  /// Transforms the lines along y (axis 1) or z (axis 2), kLanes at a time.
  void along(int axis) {
    const int length = dims_[axis];
    const size_t stride = axis == 1 ? dims_.x : size_t(dims_.x) * dims_.y;
    const size_t outerStride = axis == 1 ? size_t(dims_.x) * dims_.y : dims_.x;
    const size_t tilesInRow = (size_t(dims_.x) + kLanes - 1) / kLanes;
    const size_t tiles = tilesInRow * dims_[3 - axis];
    parallelFor(tiles, std::max<size_t>(1, 4096 / length), [&](size_t begin, size_t end) {
      progress_.report((axis + double(begin) / double(tiles)) / 3.0);
      Envelope envelope(length);
      Tile tile(length);
      for (size_t t = begin; t < end; ++t) {
        const size_t x = t % tilesInRow * kLanes;
        const size_t start = t / tilesInRow * outerStride + x;
        const int lanes = static_cast<int>(std::min<size_t>(kLanes, dims_.x - x));
        tile.load(squared_.data() + start, cells_.data() + start, stride, lanes);
        for (int lane = 0; lane < lanes; ++lane) tile.transform(envelope, lane, empty_);
        tile.store(squared_.data() + start, cells_.data() + start, stride, lanes);
      }
    });
  }

 private:
  /// kLanes lines side by side.
  struct Tile {
    explicit Tile(int n) : length(n), squared(size_t(n) * kLanes), cells(size_t(n) * kLanes) {}

    void load(const float* from, const uint32_t* cellsFrom, size_t stride, int lanes) {
      for (int p = 0; p < length; ++p) {
        std::copy_n(from + p * stride, lanes, &squared[size_t(p) * kLanes]);
        std::copy_n(cellsFrom + p * stride, lanes, &cells[size_t(p) * kLanes]);
      }
    }
    void store(float* to, uint32_t* cellsTo, size_t stride, int lanes) const {
      for (int p = 0; p < length; ++p) {
        std::copy_n(&squared[size_t(p) * kLanes], lanes, to + p * stride);
        std::copy_n(&cells[size_t(p) * kLanes], lanes, cellsTo + p * stride);
      }
    }
    void transform(Envelope& envelope, int lane, float empty) {
      envelope.clear();
      for (int q = 0; q < length; ++q) {
        const size_t at = size_t(q) * kLanes + lane;
        if (squared[at] < empty) envelope.push(q, squared[at], cells[at]);
      }
      envelope.sample([&](int p, float value, uint32_t cell) {
        squared[size_t(p) * kLanes + lane] = value;
        cells[size_t(p) * kLanes + lane] = cell;
      });
    }

    int length;
    std::vector<float> squared;
    std::vector<uint32_t> cells;
  };

  /// A line along x before the pass.
  struct Row {
    explicit Row(int n) : values(n), left(n) {}
    std::vector<float> values;
    std::vector<int> left;  ///< Nearest occupied cell at or before each, or -1.
  };

  void transformRow(Row& before, size_t row) {
    float* line = squared_.data() + row;
    std::copy_n(line, dims_.x, before.values.data());
    int last = -1, next = -1;
    for (int x = 0; x < dims_.x; ++x) {
      if (line[x] < empty_) last = x;
      before.left[x] = last;
    }
    for (int x = dims_.x; x-- > 0;) {
      if (before.values[x] < empty_) next = x;
      const int nearest = nearestOf(before, x, next);
      cells_[row + x] = nearest < 0 ? kNoCell : static_cast<uint32_t>(row + nearest);
      if (nearest < 0) continue;
      const auto d = static_cast<float>(x - nearest);
      line[x] = d * d + before.values[nearest];
    }
  }

  /// Returns the nearer of the nearest cells on both sides; of equally near ones, that of the lower value.
  static int nearestOf(const Row& row, int x, int right) {
    const int left = row.left[x];
    if (left < 0 || right < 0) return std::max(left, right);
    if (x - left != right - x) return x - left < right - x ? left : right;
    return row.values[right] < row.values[left] ? right : left;
  }

  glm::ivec3 dims_;
  float empty_;
  Progress& progress_;
  Buffer<float>& squared_;
  Buffer<uint32_t>& cells_;
};

}  // namespace

void transformDistance(glm::ivec3 dims, Progress& progress, Buffer<float>& squared,
                       Buffer<uint32_t>& nearestCell) {
  nearestCell.resizeUninitialized(squared.size());
  Transform transform(dims, progress, squared, nearestCell);
  transform.alongX();
  transform.along(1);
  transform.along(2);
}

}  // namespace raymap::cpu
