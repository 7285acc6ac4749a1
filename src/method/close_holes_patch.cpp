// Krayer & Müller 2019, §4, end: surface where the sign changes and no triangle is.
//
// Paper (future work): cells without triangles in which the sign changes get a distance of about zero before
// the distance transform. Here: triangles are added where the winding number crosses the threshold, because
// distances to them are as exact as to the mesh's own. They form surface nets (Gibson 1998): a vertex in each
// cube of samples, two triangles across each edge. At the rims of a hole the winding number is not continuous
// and all its levels meet, so the vertex lies on the rim itself.

#include "method/close_holes_patch.h"

#include <raymap/error.h>
#include <raymap/field.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

constexpr size_t kGrain = 4096;

glm::ivec3 sampleAt(size_t s, const glm::ivec3& dims) {
  const size_t nx = size_t(dims.x), ny = size_t(dims.y);
  return {s % nx, s / nx % ny, s / nx / ny};
}

/// Returns the point of an edge at this share of the way from its first sample to the next.
glm::dvec3 pointOf(const MissingEdge& edge, float share, const glm::ivec3& dims) {
  glm::dvec3 p(sampleAt(edge.first, dims));
  p[int(edge.axis)] += share;
  return p;
}

/// Finds where the winding number crosses the threshold on each edge. A first point is interpolated between
/// the samples' numbers. The secant method then uses the numbers of the triangles themselves.
class EdgeCrossings {
 public:
  EdgeCrossings(std::span<const MissingEdge> edges, const glm::ivec3& dims, double threshold)
      : edges_(edges), dims_(dims), threshold_(static_cast<float>(threshold)) {}

  std::vector<float> find(const WindingSource& windingAt) const {
    std::vector<float> before(edges_.size()), shares(edges_.size()), slopes(edges_.size());
    forEach([&](size_t e) {
      const float from = excess(edges_[e].winding[0]);
      slopes[e] = excess(edges_[e].winding[1]) - from;
      before[e] = -from / slopes[e];
    });
    const std::vector<float> first = numbersAt(before, windingAt);
    forEach([&](size_t e) { shares[e] = inside(before[e] - excess(first[e]) / slopes[e]); });
    const std::vector<float> second = numbersAt(shares, windingAt);
    forEach([&](size_t e) {
      const float slope = (excess(second[e]) - excess(first[e])) / (shares[e] - before[e]);
      const float better = inside(shares[e] - excess(second[e]) / slope);
      if (slope * slopes[e] > 0.0f) shares[e] = better;
    });
    return shares;
  }

 private:
  template <class Work>
  void forEach(Work&& work) const {
    parallelFor(edges_.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t e = begin; e < end; ++e) work(e);
    });
  }

  static float inside(float share) { return std::clamp(share, 0.0f, 1.0f); }
  float excess(float winding) const { return std::abs(winding) - threshold_; }

  std::vector<float> numbersAt(std::span<const float> shares, const WindingSource& windingAt) const {
    std::vector<glm::vec3> points(edges_.size());
    forEach([&](size_t e) { points[e] = glm::vec3(pointOf(edges_[e], shares[e], dims_)); });
    return windingAt(points);
  }

  std::span<const MissingEdge> edges_;
  glm::ivec3 dims_;
  float threshold_;
};

/// One of the four corners of the quad across an edge.
struct Corner {
  uint64_t cube;
  uint64_t place;  // 4 * edge + c
  bool operator<(const Corner& other) const {
    return cube != other.cube ? cube < other.cube : place < other.place;
  }
};

/// Returns the corners of all quads, sorted by cube.
std::vector<Corner> cornersOf(std::span<const MissingEdge> edges, const glm::ivec3& dims) {
  std::vector<Corner> corners(edges.size() * kCubesAround);
  parallelFor(edges.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e)
      for (uint32_t c = 0; c < kCubesAround; ++c) {
        const glm::ivec3 cube = cubeAround(sampleAt(edges[e].first, dims), int(edges[e].axis), int(c));
        corners[e * kCubesAround + c] = {cubeIndex(cube, dims), e * kCubesAround + c};
      }
  });
  parallelSort(corners.begin(), corners.end());
  return corners;
}

/// Vertex in a cube through which a rim of the hole runs.
struct RimVertex {
  uint64_t cube;
  size_t vertex;
};

/// Builds the triangles of a patch.
class Polygonizer {
 public:
  Polygonizer(const CellMesh& mesh, std::span<const MissingEdge> edges, double threshold,
              std::span<const float> shares)
      : mesh_(mesh),
        edges_(edges),
        threshold_(static_cast<float>(threshold)),
        shares_(shares),
        corners_(cornersOf(edges, mesh.dims)) {}

  void run(Progress& progress, HolePatch& patch) {
    placeVertices();
    moveToRims(progress);
    patch.mesh.vertices.resizeUninitialized(vertices_.size());
    std::copy(vertices_.begin(), vertices_.end(), patch.mesh.vertices.begin());
    patch.triangles.reserve(2 * edges_.size());
    for (size_t e = 0; e < edges_.size(); ++e) addQuad(e, patch.triangles);
    patch.mesh.triangles = patch.triangles;
    patch.mesh.dims = mesh_.dims;
  }

 private:
  bool isOfRim(const Corner& corner) const {
    return (edges_[corner.place / kCubesAround].rimCubes >> corner.place % kCubesAround & 1) != 0;
  }

  /// Places a vertex in each cube, at the mean of its edges' crossings.
  void placeVertices() {
    vertexOf_.resize(corners_.size());
    for (size_t begin = 0, end = 0; begin < corners_.size(); begin = end) {
      if (isOfRim(corners_[begin])) rimVertices_.push_back({corners_[begin].cube, vertices_.size()});
      glm::dvec3 sum(0.0);
      for (; end < corners_.size() && corners_[end].cube == corners_[begin].cube; ++end) {
        const uint64_t e = corners_[end].place / kCubesAround;
        sum += pointOf(edges_[e], shares_[e], mesh_.dims);
        vertexOf_[corners_[end].place] = uint32_t(vertices_.size());
      }
      vertices_.emplace_back(sum / double(end - begin));
    }
  }

  /// Moves the vertices at the patch's ends to the rim in their cubes. If a cube has none, its vertex moves
  /// to the rim in a neighbouring cube: between lattice lines the mesh may end a little farther away.
  void moveToRims(Progress& progress) {
    std::vector<uint64_t> cubes;
    for (const RimVertex& v : rimVertices_) cubes.push_back(v.cube);
    const std::vector<RimPart> parts = findRims(mesh_, cubes, progress);
    std::vector<RimVertex> lost;
    for (size_t r = 0; r < parts.size(); ++r)
      if (parts[r].length > 0.0)
        vertices_[rimVertices_[r].vertex] = glm::vec3(parts[r].middle);
      else
        lost.push_back(rimVertices_[r]);
    const std::vector<uint64_t> around = neighboursOf(lost);
    const std::vector<RimPart> near = findRims(mesh_, around, progress);
    for (const RimVertex& v : lost) vertices_[v.vertex] = closest(v, around, near);
  }

  std::vector<uint64_t> neighboursOf(std::span<const RimVertex> vertices) const {
    std::vector<uint64_t> cubes;
    for (const RimVertex& v : vertices)
      forEachNeighbour(v.cube, [&](uint64_t cube) { cubes.push_back(cube); });
    std::sort(cubes.begin(), cubes.end());
    cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
    return cubes;
  }

  /// Returns the rim point closest to a vertex in the cubes around its own, or the vertex if there is none.
  glm::vec3 closest(const RimVertex& v, std::span<const uint64_t> cubes,
                    std::span<const RimPart> parts) const {
    glm::vec3 best = vertices_[v.vertex];
    float least = INFINITY;
    forEachNeighbour(v.cube, [&](uint64_t cube) {
      const RimPart& part = parts[size_t(std::lower_bound(cubes.begin(), cubes.end(), cube) - cubes.begin())];
      const float distance = glm::distance(glm::vec3(part.middle), vertices_[v.vertex]);
      if (!(part.length > 0.0) || !(distance < least)) return;
      least = distance;
      best = glm::vec3(part.middle);
    });
    return best;
  }

  /// Calls `work` with a rim cube and the 26 cubes around it. They all exist, because a rim cube has all of
  /// its samples in the grid.
  template <class Work>
  void forEachNeighbour(uint64_t cube, Work&& work) const {
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          work(cube + uint64_t((int64_t(k) * (mesh_.dims.y + 1) + j) * (mesh_.dims.x + 1) + i));
  }

  /// Adds the quad across an edge, cut along its shorter diagonal.
  void addQuad(size_t e, std::vector<glm::uvec3>& triangles) const {
    uint32_t v[kCubesAround];
    std::copy_n(vertexOf_.begin() + std::ptrdiff_t(e * kCubesAround), kCubesAround, v);
    if (!(std::abs(edges_[e].winding[0]) > threshold_)) std::swap(v[1], v[3]);
    const auto length2 = [&](int a, int b) {
      const glm::vec3 d = vertices_[v[a]] - vertices_[v[b]];
      return glm::dot(d, d);
    };
    const int first = length2(0, 2) <= length2(1, 3) ? 0 : 1;
    triangles.emplace_back(v[first], v[first + 1], v[first + 2]);
    triangles.emplace_back(v[first], v[first + 2], v[(first + 3) % kCubesAround]);
  }

  const CellMesh& mesh_;
  std::span<const MissingEdge> edges_;
  float threshold_;
  std::span<const float> shares_;
  std::vector<Corner> corners_;
  std::vector<uint32_t> vertexOf_;  // by `Corner::place`
  std::vector<glm::vec3> vertices_;
  std::vector<RimVertex> rimVertices_;
};

}  // namespace

glm::ivec3 cubeAround(const glm::ivec3& sample, int axis, int c) {
  glm::ivec3 cube = sample;
  ++cube[axis];
  cube[(axis + 1) % 3] += c == 1 || c == 2 ? 1 : 0;
  cube[(axis + 2) % 3] += c >= 2 ? 1 : 0;
  return cube;
}

void HolePatch::clear() {
  triangles.clear();
  mesh.vertices.resizeUninitialized(0);
  mesh.triangles = {};
}

double HolePatch::area() const {
  double area = 0.0;
  for (size_t t = 0; t < triangles.size(); ++t) {
    const glm::dvec3 a(mesh.corner(t, 0)), b(mesh.corner(t, 1)), c(mesh.corner(t, 2));
    area += triangleArea(a, b, c);
  }
  return area;
}

void requirePatch(size_t missingEdges, size_t treeBytes, size_t bytesLeft) {
  constexpr size_t kOfEdge =
                       sizeof(MissingEdge) + 5 * sizeof(float) + sizeof(glm::vec3) + 2 * sizeof(glm::uvec3),
                   kOfCorner = sizeof(Corner) + sizeof(uint32_t) + 2 * sizeof(glm::vec3);
  const size_t left = bytesLeft - std::min(bytesLeft, treeBytes);
  if (missingEdges > left / (kOfEdge + kCubesAround * kOfCorner) || 2 * missingEdges >= kNoTriangle)
    throw Error(ErrorCode::Memory, "surface is missing at " + std::to_string(missingEdges) +
                                       " lattice edges, too many to close in the memory left; use a lower "
                                       "resolution or a higher limit");
}

void makePatch(const CellMesh& mesh, std::span<const MissingEdge> edges, double threshold,
               const WindingSource& windingAt, Progress& progress, HolePatch& patch) {
  patch.clear();
  const std::vector<float> shares = EdgeCrossings(edges, mesh.dims, threshold).find(windingAt);
  Polygonizer(mesh, edges, threshold, shares).run(progress, patch);
}

}  // namespace raymap
