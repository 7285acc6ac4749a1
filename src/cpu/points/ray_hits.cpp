// Ours: crossings of one ray, for the local thickness of a mesh.

#include "cpu/points/ray_hits.h"

#include <algorithm>
#include <cmath>

#include "mesh/triangle.h"
#include "predicates/line_triangle.h"

namespace raymap::cpu {

namespace {

/// Frame whose axis z is the direction of a ray and whose origin is its start.
class RayFrame {
 public:
  RayFrame(const glm::dvec3& from, const glm::dvec3& direction) : from_(from), z_(direction) {
    const glm::dvec3 other = std::abs(z_.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    x_ = glm::normalize(glm::cross(other, z_));
    y_ = glm::cross(z_, x_);
  }

  glm::dvec3 operator()(const glm::dvec3& p) const {
    const glm::dvec3 d = p - from_;
    return {glm::dot(d, x_), glm::dot(d, y_), glm::dot(d, z_)};
  }

 private:
  glm::dvec3 from_, x_, y_, z_;
};

}  // namespace

void findRayHits(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                 const glm::dvec3& from, const glm::dvec3& direction, std::vector<RayHit>& hits) {
  hits.clear();
  const RayFrame frame(from, direction);
  for (const uint32_t f : faces) {
    const uint8_t turn = turns.empty() ? kAsGiven : turns[f];
    if (turn == kLeftOut) continue;
    const auto [p, q, r] = mesh.corners(turned(mesh.triangles[f], turn));
    const glm::dvec3 a = frame(p), b = frame(q), c = frame(r);
    const auto [side, weights] = passLine(glm::dvec2(a), glm::dvec2(b), glm::dvec2(c));
    if (side == 0) continue;
    const double area = weights.x + weights.y + weights.z;
    const double distance = (weights.x * a.z + weights.y * b.z + weights.z * c.z) / area;
    const glm::dvec3 normal = doubleAreaNormal(p, q, r);
    const double length = glm::length(normal);
    if (area == 0.0 || length == 0.0 || distance < 0.0) continue;
    hits.push_back({distance, normal * (side / length), f, -side});
  }
  std::ranges::sort(hits, [](const RayHit& l, const RayHit& r) {
    return l.distance != r.distance ? l.distance < r.distance : l.triangle < r.triangle;
  });
}

}  // namespace raymap::cpu
