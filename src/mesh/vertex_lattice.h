#pragma once

#include <algorithm>
#include <cmath>

#include "mesh/packed_mesh.h"
#include "predicates/triangle_triangle.h"

namespace raymap {

/// Puts vertices on a lattice of 2^29 to 2^30 steps along the longest side of the mesh. Steps are powers of
/// two, so most single-precision numbers lie on the lattice and faces that touch still do.
class VertexLattice {
 public:
  explicit VertexLattice(const PackedMesh& mesh) : mesh_(mesh) {
    const Box box = bounds(mesh);
    const glm::dvec3 size = box.size();
    int exponent = 0;
    std::frexp(0.5 * std::max({size.x, size.y, size.z}), &exponent);
    scale_ = std::ldexp(1.0, kTriangleBits - exponent);
    centre_ = glm::round((box.centre() - mesh.origin) * scale_);
  }

  glm::ivec3 vertex(size_t v) const {
    const glm::dvec3 p = scale_ * glm::dvec3(mesh_.vertices[v]);
    return glm::ivec3(glm::dvec3(roundFast(p.x), roundFast(p.y), roundFast(p.z)) - centre_);
  }
  WholeTriangle face(size_t f) const {
    const glm::uvec3& t = mesh_.triangles[f];
    return {vertex(t.x), vertex(t.y), vertex(t.z)};
  }
  /// Returns a place between vertices, relative to the mesh's origin.
  glm::dvec3 placeOf(const glm::dvec3& steps) const { return (steps + centre_) / scale_; }

 private:
  /// Returns what `std::round` does, without its call.
  static double roundFast(double x) {
    if (!(std::abs(x) < 0x1p51)) return std::round(x);
    constexpr double kWhole = 0x1.8p52;  // Numbers of this size have no fraction.
    const double even = (x + kWhole) - kWhole, rest = x - even;
    if (rest == 0.5 && x > 0.0) return even + 1.0;
    if (rest == -0.5 && x < 0.0) return even - 1.0;
    return even;
  }

  PackedMesh mesh_;
  double scale_;
  glm::dvec3 centre_;
};

}  // namespace raymap
