// Finds the rims of the surface, which a patch over a hole must meet (stage `close_holes`).

#include "method/close_holes_rims.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace raymap {

namespace {

constexpr size_t kTrianglesPerTask = 4096;

struct Segment {
  glm::vec3 a, b;

  /// Returns the same segment for every triangle that it is an edge of, and for 0 and -0.
  static Segment between(const glm::vec3& a, const glm::vec3& b) {
    const Segment segment{a + 0.0f, b + 0.0f}, reversed{segment.b, segment.a};
    return segment < reversed ? segment : reversed;
  }
  bool operator<(const Segment& other) const { return key() < other.key(); }
  bool operator==(const Segment& other) const { return key() == other.key(); }

 private:
  std::tuple<float, float, float, float, float, float> key() const { return {a.x, a.y, a.z, b.x, b.y, b.z}; }
};

/// Cuts segments at the planes between cubes.
class SegmentCutter {
 public:
  explicit SegmentCutter(const glm::ivec3& dims) : dims_(dims) {}

  /// Calls `work(cube, middle, length)` for each part of the segment inside the grid.
  template <class Work>
  void forEachPart(const Segment& segment, Work&& work) {
    const glm::dvec3 start(segment.a), along = glm::dvec3(segment.b) - start;
    if (!cut(start, along)) return;
    const double length = glm::length(along);
    for (size_t s = 0; s + 1 < stops_.size(); ++s) {
      const glm::dvec3 middle = start + 0.5 * (stops_[s] + stops_[s + 1]) * along;
      work(cubeIndex(glm::clamp(glm::ivec3(glm::floor(middle)) + 1, glm::ivec3(0), dims_), dims_), middle,
           (stops_[s + 1] - stops_[s]) * length);
    }
  }

 private:
  /// Fills `stops_`. Returns whether any part of the segment lies inside the grid.
  bool cut(const glm::dvec3& start, const glm::dvec3& along) {
    double first = 0.0, last = 1.0;
    for (int c = 0; c < 3; ++c) {
      const double low = -start[c], high = dims_[c] - 1 - start[c];
      if (along[c] == 0.0 && (low > 0.0 || high < 0.0)) return false;
      if (along[c] == 0.0) continue;
      first = std::max(first, std::min(low / along[c], high / along[c]));
      last = std::min(last, std::max(low / along[c], high / along[c]));
    }
    if (!(first < last)) return false;
    stops_.assign({first, last});
    for (int c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax({start[c] + first * along[c], start[c] + last * along[c]});
      for (int plane = static_cast<int>(std::ceil(low)); plane <= high; ++plane) {
        const double stop = (plane - start[c]) / along[c];
        if (stop > first && stop < last) stops_.push_back(stop);
      }
    }
    std::sort(stops_.begin(), stops_.end());
    return true;
  }

  glm::ivec3 dims_;
  std::vector<double> stops_;
};

/// Set of cubes with fast look-up.
class CubeSet {
 public:
  CubeSet(std::span<const uint64_t> cubes, const glm::ivec3& dims)
      : bits_((cubeIndex(dims, dims) + 64) / 64, 0) {
    for (const uint64_t cube : cubes) {
      bits_[cube / 64] |= uint64_t{1} << cube % 64;
      const glm::uvec3 size(dims + 1);
      const glm::vec3 high(glm::u64vec3(cube % size.x, cube / size.x % size.y, cube / size.x / size.y));
      low_ = glm::min(low_, high - 1.0f);
      high_ = glm::max(high_, high);
    }
  }

  bool has(uint64_t cube) const { return (bits_[cube / 64] >> cube % 64 & 1) != 0; }
  /// Returns whether the triangle surely misses all cubes.
  bool isFarFrom(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const {
    const glm::vec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    return glm::any(glm::lessThan(high, low_)) || glm::any(glm::greaterThan(low, high_));
  }

 private:
  std::vector<uint64_t> bits_;
  glm::vec3 low_{INFINITY}, high_{-INFINITY};
};

/// Returns the triangle edges that pass through the cubes, sorted, once for each triangle.
std::vector<Segment> edgesThrough(const CellMesh& mesh, const CubeSet& cubes, Progress& progress) {
  const size_t count = mesh.triangles.size();
  std::vector<std::vector<Segment>> lists((count + kTrianglesPerTask - 1) / kTrianglesPerTask);
  parallelFor(lists.size(), 1, [&](size_t list, size_t) {
    progress.poll();
    SegmentCutter cutter(mesh.dims);
    const size_t end = std::min((list + 1) * kTrianglesPerTask, count);
    for (size_t t = list * kTrianglesPerTask; t < end; ++t) {
      const glm::vec3 corners[] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
      if (cubes.isFarFrom(corners[0], corners[1], corners[2])) continue;
      for (int c = 0; c < 3; ++c) {
        const Segment edge = Segment::between(corners[c], corners[(c + 1) % 3]);
        bool passes = false;
        cutter.forEachPart(
            edge, [&](uint64_t cube, const glm::dvec3&, double) { passes = passes || cubes.has(cube); });
        if (passes) lists[list].push_back(edge);
      }
    }
  });
  std::vector<Segment> edges;
  for (const std::vector<Segment>& list : lists) edges.insert(edges.end(), list.begin(), list.end());
  parallelSort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

std::vector<RimPart> findRims(const CellMesh& mesh, std::span<const uint64_t> cubes, Progress& progress) {
  std::vector<RimPart> parts(cubes.size());
  if (cubes.empty()) return parts;
  const CubeSet set(cubes, mesh.dims);
  const std::vector<Segment> edges = edgesThrough(mesh, set, progress);
  SegmentCutter cutter(mesh.dims);
  for (auto edge = edges.begin(); edge != edges.end();) {
    const auto next =
        std::find_if(edge, edges.end(), [&](const Segment& other) { return !(other == *edge); });
    if ((next - edge) % 2 != 0)
      cutter.forEachPart(*edge, [&](uint64_t cube, const glm::dvec3& middle, double length) {
        if (!set.has(cube)) return;
        RimPart& part = parts[size_t(std::lower_bound(cubes.begin(), cubes.end(), cube) - cubes.begin())];
        part.middle += length * middle;
        part.length += length;
      });
    edge = next;
  }
  for (RimPart& part : parts)
    if (part.length > 0.0) part.middle /= part.length;
  return parts;
}

}  // namespace raymap
