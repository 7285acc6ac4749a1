#include "repair/topology/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mesh/triangle.h"
#include "repair/topology/rims.h"

namespace raymap {

namespace {

constexpr size_t kMostEdges = 300;  // Of a rim that is filled at once: the time grows with the cube.
constexpr size_t kFewEdges = 150;   // About so many of a longer rim are filled first.

/// Finds the best triangulation of a rim by dynamic programming over its parts.
class RimFiller {
 public:
  static constexpr size_t kRim = SIZE_MAX;

  RimFiller(const Mesh& mesh, const Rim& rim)
      : mesh_(mesh), rim_(rim), size_(rim.size()), best_(size_ * size_) {
    for (size_t length = 2; length < size_; ++length)
      for (size_t i = 0; i + length < size_; ++i) best_[i * size_ + i + length] = bestBetween(i, i + length);
  }

  /// Calls `visit(triangle, beyond)` with the places of the corners of each triangle in the rim, ascending,
  /// and the place of the third corner of the triangle beyond each of its sides: 0 to 1, 1 to 2, 2 to 0. At
  /// the rim, that is `kRim`.
  template <class Visit>
  void forEachTriangle(Visit&& visit) const {
    std::vector<glm::u64vec3> parts{{0, size_ - 1, kRim}};
    while (!parts.empty()) {
      const size_t i = parts.back().x, j = parts.back().y, outer = parts.back().z;
      parts.pop_back();
      if (j == i + 1) continue;
      const size_t k = at(i, j).middle;
      visit(glm::u64vec3(i, k, j), glm::u64vec3(beyond(i, k), beyond(k, j), outer));
      parts.emplace_back(i, k, j);
      parts.emplace_back(k, j, i);
    }
  }

 private:
  /// Cost of a part: first the sharpest edge, 0 if flat and 2 if folded; then the area.
  struct Part {
    double sharpness = 0.0, area = 0.0;
    size_t middle = 0;

    bool operator<(const Part& other) const {
      return std::pair(sharpness, area) < std::pair(other.sharpness, other.area);
    }
  };

  size_t beyond(size_t i, size_t j) const { return j == i + 1 ? kRim : at(i, j).middle; }
  const Part& at(size_t i, size_t j) const { return best_[i * size_ + j]; }
  glm::dvec3 corner(size_t i) const { return glm::dvec3(mesh_.vertices[rim_[i].from]); }

  static double sharpness(const glm::dvec3& n, const glm::dvec3& m) {
    const double lengths = glm::length(n) * glm::length(m);
    return lengths > 0.0 ? 1.0 - glm::dot(n, m) / lengths : 2.0;
  }

  /// Returns the normal of the face beyond the edge from i to j: of the mesh, or of the part between them.
  glm::dvec3 normalBeyond(size_t i, size_t j) const {
    if (j != i + 1) return doubleAreaNormal(corner(i), corner(at(i, j).middle), corner(j));
    return normalOfMesh(i);
  }
  glm::dvec3 normalOfMesh(size_t i) const {
    const BorderEdge& edge = rim_[i];
    const auto position = [&](uint32_t v) { return glm::dvec3(mesh_.vertices[v]); };
    return doubleAreaNormal(position(edge.to), position(edge.from), position(edge.third));
  }

  Part bestBetween(size_t i, size_t j) const {
    Part best{.sharpness = INFINITY};
    for (size_t k = i + 1; k < j; ++k) {
      const glm::dvec3 n = doubleAreaNormal(corner(i), corner(k), corner(j));
      Part part{.sharpness = std::max({at(i, k).sharpness, at(k, j).sharpness,
                                       sharpness(n, normalBeyond(i, k)), sharpness(n, normalBeyond(k, j))}),
                .area = at(i, k).area + at(k, j).area + 0.5 * glm::length(n),
                .middle = k};
      if (i == 0 && j == size_ - 1) part.sharpness = std::max(part.sharpness, sharpness(n, normalOfMesh(j)));
      if (part < best) best = part;
    }
    return best;
  }

  const Mesh& mesh_;
  const Rim& rim_;
  size_t size_;
  std::vector<Part> best_;  // Best filling of the part from the first index to the second.
};

/// Fills a rim. In a long one, every few vertices are joined first; each of their triangles then has a rim of
/// its own, through all vertices between its corners.
void fillRim(const Mesh& mesh, const Rim& rim, std::vector<glm::uvec3>& triangles) {
  const size_t step = rim.size() <= kMostEdges ? 1 : (rim.size() + kFewEdges - 1) / kFewEdges;
  Rim few;
  for (size_t e = 0; e < rim.size(); e += step) few.push_back(rim[e]);
  RimFiller(mesh, few).forEachTriangle([&](const glm::u64vec3& corners, const glm::u64vec3& beyond) {
    const auto vertex = [&](size_t place) { return few[place].from; };
    if (step == 1)
      return void(triangles.emplace_back(vertex(corners.x), vertex(corners.y), vertex(corners.z)));
    Rim part;
    for (int side = 0; side < 3; ++side) {
      const size_t from = corners[side], to = corners[(side + 1) % 3];
      if (beyond[side] != RimFiller::kRim)
        part.push_back({vertex(from), vertex(to), vertex(beyond[side])});
      else
        part.insert(part.end(), rim.begin() + ptrdiff_t(from * step),
                    rim.begin() + ptrdiff_t(std::min((from + 1) * step, rim.size())));
    }
    fillRim(mesh, part, triangles);
  });
}

/// Moves the rims with an edge that faces use twice in one direction to the end. Returns the first of them.
std::vector<Rim>::iterator moveTwisted(std::vector<Rim>& rims) {
  std::vector<std::pair<uint32_t, uint32_t>> edges, twice;
  for (const Rim& rim : rims)
    for (const BorderEdge& edge : rim) edges.emplace_back(edge.from, edge.to);
  std::ranges::sort(edges);
  for (size_t e = 1; e < edges.size(); ++e)
    if (edges[e] == edges[e - 1]) twice.push_back(edges[e]);
  return std::stable_partition(rims.begin(), rims.end(), [&](const Rim& rim) {
    return std::ranges::none_of(rim, [&](const BorderEdge& edge) {
      return std::ranges::binary_search(twice, std::pair(edge.from, edge.to));
    });
  });
}

}  // namespace

FilledHoles fillHoles(Mesh& mesh) {
  std::vector<Rim> rims = findRims(mesh, BorderEdges::Unbalanced).closed;
  if (std::ranges::any_of(rims, [](const Rim& rim) { return rim.size() < 3; })) return {};
  using Place = std::vector<Rim>::const_iterator;
  const auto fill = [&](Place first, Place last) {
    const size_t before = mesh.triangles.size();
    for (Place rim = first; rim != last; ++rim) fillRim(mesh, *rim, mesh.triangles);
    return mesh.triangles.size() - before;
  };
  const Place twisted = moveTwisted(rims);
  const size_t faces = fill(rims.begin(), twisted), twistedFaces = fill(twisted, rims.end());
  return {rims.size(), faces + twistedFaces, twistedFaces};
}

}  // namespace raymap
