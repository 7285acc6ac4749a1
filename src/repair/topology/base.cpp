#include "repair/topology/base.h"

#include <raymap/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/text.h"
#include "mesh/disjoint_sets.h"
#include "mesh/packed_mesh.h"
#include "mesh/triangle.h"
#include "repair/topology/rims.h"

namespace raymap {

namespace {

/// Turns the open parts that point down as a whole.
void turnUp(Mesh& mesh, const Rims& rims, const glm::dvec3& up) {
  DisjointSets sets(mesh.vertices.size());
  for (const glm::uvec3& t : mesh.triangles) sets.link(t.x, t.y), sets.link(t.y, t.z);
  std::map<uint32_t, double> area;  // Of open parts, seen from above.
  for (const Rim& rim : rims.closed) area.emplace(sets.root(rim[0].from), 0.0);
  const auto partOf = [&](const glm::uvec3& t) { return area.find(sets.root(t.x)); };
  for (const glm::uvec3& t : mesh.triangles)
    if (const auto part = partOf(t); part != area.end()) {
      const auto [a, b, c] = PackedMesh(mesh).corners(t);
      part->second += glm::dot(doubleAreaNormal(a, b, c), up);
    }
  for (glm::uvec3& t : mesh.triangles)
    if (const auto part = partOf(t); part != area.end() && part->second < 0.0) std::swap(t.y, t.z);
}

constexpr double kRounding =
    1e-7;  // Height over the base that may be rounding, as a share of the mesh's size.

/// Plane of the base.
class Base {
 public:
  Base(Mesh& mesh, double base, const glm::dvec3& up) : mesh_(mesh), base_(base), up_(up) {
    const glm::dvec3 size = bounds(mesh).size();
    slack_ = kRounding * std::max({size.x, size.y, size.z});
  }

  double heightOver(uint32_t vertex) const { return glm::dot(mesh_.position(vertex), up_) - base_; }
  bool isBelow(double height) const { return height < -slack_; }

  /// Returns the vertex in the plane below one, which may be the same.
  uint32_t below(uint32_t vertex) {
    const auto [place, isNew] = below_.try_emplace(vertex, vertex);
    if (const double height = heightOver(vertex); isNew && height > slack_) {
      place->second = uint32_t(mesh_.vertices.size());
      mesh_.vertices.push_back(lowered(vertex, height));
    }
    return place->second;
  }

  void addWall(const BorderEdge& edge) {
    const uint32_t from = below(edge.from), to = below(edge.to);
    if (to != edge.to) mesh_.triangles.emplace_back(edge.from, edge.to, to);
    if (from != edge.from) mesh_.triangles.emplace_back(edge.from, to, from);
  }

 private:
  /// Along an axis, all coordinates of the plane's vertices are the same.
  glm::vec3 lowered(uint32_t vertex, double height) const {
    glm::vec3 p = mesh_.vertices[vertex];
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(up_[axis]) == 1.0) {
        p[axis] = float(up_[axis] * base_ - mesh_.origin[axis]);
        return p;
      }
    return glm::vec3(glm::dvec3(p) - height * up_);
  }

  Mesh& mesh_;
  double base_, slack_;
  glm::dvec3 up_;
  std::map<uint32_t, uint32_t> below_;
};

}  // namespace

void joinToBase(Mesh& mesh, double base, const glm::dvec3& down) {
  const glm::dvec3 up = -down / glm::length(down);
  const Rims before = findRims(mesh);
  if (before.closed.empty() && before.open.empty())
    throw Error(ErrorCode::Input, "the mesh has no open edge to join to a base; leave the base out");
  if (!before.open.empty())
    throw Error(
        ErrorCode::Input,
        "the rim of the mesh does not close, so it cannot be joined to a base: edges with more than two "
        "faces lie on it; remove these faces, or give the sheet a thickness");
  turnUp(mesh, before, up);
  Base plane(mesh, base, up);
  double lowest = INFINITY;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) lowest = std::min(lowest, plane.heightOver(t[c]));
  if (plane.isBelow(lowest))
    throw Error(ErrorCode::Input, "the mesh reaches " + numberText(-lowest, 6) + " below the base of " +
                                      numberText(base, 6) + "; use one of at most " +
                                      numberText(base + lowest, 6));
  for (const Rim& rim : findRims(mesh).closed)
    for (const BorderEdge& edge : rim) plane.addWall(edge);
}

}  // namespace raymap
