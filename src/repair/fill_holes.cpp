#include "repair/fill_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace raymap {

namespace {

constexpr size_t kMostEdges = 300;  // The time grows with the cube.

/// An edge of a rim in the direction in which a face of the hole uses it, and the third corner of its face.
struct RimEdge {
  uint32_t from, to, third;
};

/// Returns the edges that only one face uses, by their first vertex.
std::vector<RimEdge> findRimEdges(const Mesh& mesh) {
  struct Use {
    uint32_t low, high, third;
    bool isForward;
    bool operator<(const Use& other) const { return std::pair(low, high) < std::pair(other.low, other.high); }
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = t[c], b = t[(c + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), t[(c + 2) % 3], a < b});
    }
  std::sort(uses.begin(), uses.end());
  std::vector<RimEdge> rim;
  for (size_t first = 0, next = 0; first < uses.size(); first = next) {
    while (next < uses.size() && !(uses[first] < uses[next])) ++next;
    if (const auto& [low, high, third, isForward] = uses[first]; next == first + 1)
      rim.push_back({isForward ? high : low, isForward ? low : high, third});
  }
  std::ranges::sort(rim, {}, &RimEdge::from);
  return rim;
}

using Rim = std::vector<RimEdge>;

/// Joins edges to closed rims. Where rims meet in a vertex, a rim is split off as soon as it closes. Returns
/// nothing if one does not close, or has too few or too many edges.
std::optional<std::vector<Rim>> traceRims(const std::vector<RimEdge>& edges, size_t vertices) {
  constexpr uint32_t kNowhere = UINT32_MAX;
  std::vector<uint32_t> placeOf(vertices, kNowhere);  // Of the vertex on the path.
  std::vector<bool> isUsed(edges.size());
  std::vector<Rim> rims;
  Rim path;
  for (size_t first = 0; first < edges.size(); ++first) {
    for (size_t at = first; !isUsed[at];) {
      isUsed[at] = true;
      placeOf[edges[at].from] = uint32_t(path.size());
      path.push_back(edges[at]);
      const uint32_t to = edges[at].to;
      if (const uint32_t place = placeOf[to]; place != kNowhere) {
        rims.emplace_back(path.begin() + place, path.end());
        if (rims.back().size() < 3 || rims.back().size() > kMostEdges) return {};
        for (const RimEdge& edge : rims.back()) placeOf[edge.from] = kNowhere;
        path.resize(place);
        if (path.empty()) break;
      }
      at = size_t(std::ranges::lower_bound(edges, to, {}, &RimEdge::from) - edges.begin());
      while (at < edges.size() && edges[at].from == to && isUsed[at]) ++at;
      if (at == edges.size() || edges[at].from != to) return {};
    }
  }
  return rims;
}

/// Finds the best triangulation of a rim by dynamic programming over its parts.
class RimFiller {
 public:
  RimFiller(const Mesh& mesh, const Rim& rim)
      : mesh_(mesh), rim_(rim), size_(rim.size()), best_(size_ * size_) {
    for (size_t length = 2; length < size_; ++length)
      for (size_t i = 0; i + length < size_; ++i) best_[i * size_ + i + length] = bestBetween(i, i + length);
  }

  void append(std::vector<glm::uvec3>& triangles) const {
    std::vector<std::pair<size_t, size_t>> parts{{0, size_ - 1}};
    while (!parts.empty()) {
      const auto [i, j] = parts.back();
      parts.pop_back();
      if (j == i + 1) continue;
      const size_t k = at(i, j).middle;
      triangles.emplace_back(rim_[i].from, rim_[k].from, rim_[j].from);
      parts.emplace_back(i, k);
      parts.emplace_back(k, j);
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

  const Part& at(size_t i, size_t j) const { return best_[i * size_ + j]; }
  glm::dvec3 corner(size_t i) const { return glm::dvec3(mesh_.vertices[rim_[i].from]); }
  glm::dvec3 normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
    return glm::cross(b - a, c - a);
  }

  static double sharpness(const glm::dvec3& n, const glm::dvec3& m) {
    const double lengths = glm::length(n) * glm::length(m);
    return lengths > 0.0 ? 1.0 - glm::dot(n, m) / lengths : 2.0;
  }

  /// Returns the normal of the face beyond the edge from i to j: of the mesh, or of the part between them.
  glm::dvec3 normalBeyond(size_t i, size_t j) const {
    if (j != i + 1) return normal(corner(i), corner(at(i, j).middle), corner(j));
    return normalOfMesh(i);
  }
  glm::dvec3 normalOfMesh(size_t i) const {
    const RimEdge& edge = rim_[i];
    const auto position = [&](uint32_t v) { return glm::dvec3(mesh_.vertices[v]); };
    return normal(position(edge.to), position(edge.from), position(edge.third));
  }

  Part bestBetween(size_t i, size_t j) const {
    Part best{.sharpness = INFINITY};
    for (size_t k = i + 1; k < j; ++k) {
      const glm::dvec3 n = normal(corner(i), corner(k), corner(j));
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
  std::vector<Part> best_;  // Of the part from the first index to the second.
};

}  // namespace

FilledHoles fillHoles(Mesh& mesh) {
  const auto rims = traceRims(findRimEdges(mesh), mesh.vertices.size());
  if (!rims) return {};
  const size_t before = mesh.triangles.size();
  for (const Rim& rim : *rims) RimFiller(mesh, rim).append(mesh.triangles);
  return {rims->size(), mesh.triangles.size() - before};
}

}  // namespace raymap
