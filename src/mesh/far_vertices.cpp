#include "mesh/far_vertices.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

namespace raymap {

namespace {

constexpr double kFarSizes = 1e9;

double longestSideOf(const glm::dvec3& sides) {
  return std::max({sides.x, sides.y, sides.z});
}

/// Returns how far a position lies beyond a box, along the axis where it is most; 0 within.
double beyondBox(const Box& box, const glm::dvec3& p) {
  return std::max(longestSideOf(glm::max(box.min - p, p - box.max)), 0.0);
}

/// Returns the box between the quartiles of the coordinates of corners that are spread evenly.
template <class Vec>
Box quartilesOf(std::span<const Vec> positions, std::span<const glm::uvec3> triangles) {
  constexpr size_t kMost = 4096;
  const size_t corners = 3 * triangles.size(), step = (corners + kMost - 1) / kMost;
  std::array<std::vector<double>, 3> values;
  for (size_t corner = 0; corner < corners; corner += step)
    for (int axis = 0; axis < 3; ++axis)
      values[size_t(axis)].push_back(positions[triangles[corner / 3][int(corner % 3)]][axis]);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double>& all = values[size_t(axis)];
    const auto quarter = std::ptrdiff_t(all.size() / 4);
    std::ranges::nth_element(all, all.begin() + quarter);
    box.min[axis] = all[size_t(quarter)];
    std::ranges::nth_element(all, all.end() - 1 - quarter);
    box.max[axis] = *(all.end() - 1 - quarter);
  }
  return box;
}

/// Returns the bounds of the vertices of faces that lie within a distance of a box.
template <class Vec>
Box boundsNear(const Box& box, double distance, std::span<const Vec> positions,
               std::span<const glm::uvec3> triangles) {
  Box near = box;
  for (const glm::uvec3& triangle : triangles)
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p(positions[triangle[c]]);
      if (beyondBox(box, p) >= distance) continue;
      near.min = glm::min(near.min, p);
      near.max = glm::max(near.max, p);
    }
  return near;
}

template <class Vec>
FarVertices findFar(const Box& bounds, std::span<const Vec> positions,
                    std::span<const glm::uvec3> triangles) {
  FarVertices found{.others = bounds};
  if (triangles.empty()) return found;
  const Box middle = quartilesOf(positions, triangles);
  const double spread = longestSideOf(middle.size());
  if (spread == 0.0 || longestSideOf(bounds.size()) < kFarSizes * spread) return found;
  const Box others = boundsNear(middle, kFarSizes * spread, positions, triangles);
  found.size = longestSideOf(others.size());
  std::vector<std::tuple<double, double, double>> far;
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p(positions[triangles[t][c]]);
      const double distance = beyondBox(others, p);
      if (distance < kFarSizes * found.size) continue;
      far.emplace_back(p.x, p.y, p.z);
      if (distance <= found.distance) continue;
      found.distance = distance;
      found.vertex = triangles[t][c];
      found.face = t;
    }
  std::ranges::sort(far);
  found.count = size_t(std::unique(far.begin(), far.end()) - far.begin());
  if (found.count > 0) found.others = others;
  return found;
}

}  // namespace

FarVertices findFarVertices(const Box& bounds, std::span<const glm::vec3> positions,
                            std::span<const glm::uvec3> triangles) {
  return findFar(bounds, positions, triangles);
}

FarVertices findFarVertices(const Box& bounds, std::span<const glm::dvec3> positions,
                            std::span<const glm::uvec3> triangles) {
  return findFar(bounds, positions, triangles);
}

}  // namespace raymap
