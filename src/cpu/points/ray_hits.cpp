// Ours: crossings of one ray, for the local thickness of a mesh.

#include "cpu/points/ray_hits.h"

#include <algorithm>
#include <cmath>

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

/// Returns twice the area of the triangle of the ray and an edge, seen along the ray. The same edge taken
/// backwards gives exactly the negative, which needs a compiler that does not fuse operations.
double edgeArea(const glm::dvec3& a, const glm::dvec3& b) {
  return a.x * b.y - a.y * b.x;
}

/// Returns the side of an edge on which the ray lies, +1 or -1. A ray that meets the edge counts as moved by
/// an infinitely small step along -x, and by an infinitely smaller one along -y. 0 only if a = b.
int sideOf(const glm::dvec3& a, const glm::dvec3& b) {
  const auto sign = [](double v) { return (v > 0.0) - (v < 0.0); };
  if (const int side = sign(edgeArea(a, b)); side != 0) return side;
  if (const int side = sign(b.y - a.y); side != 0) return side;
  return sign(a.x - b.x);
}

}  // namespace

void findRayHits(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                 const glm::dvec3& from, const glm::dvec3& direction, std::vector<RayHit>& hits) {
  hits.clear();
  const RayFrame frame(from, direction);
  for (const uint32_t f : faces) {
    const uint8_t turn = turns.empty() ? kAsGiven : turns[f];
    if (turn == kLeftOut) continue;
    const glm::uvec3 face = turned(mesh.triangles[f], turn);
    const glm::dvec3 p(mesh.vertices[face.x]), q(mesh.vertices[face.y]), r(mesh.vertices[face.z]);
    const glm::dvec3 a = frame(p), b = frame(q), c = frame(r);
    const int side = sideOf(a, b);
    if (side == 0 || sideOf(b, c) != side || sideOf(c, a) != side) continue;
    const double wa = edgeArea(b, c), wb = edgeArea(c, a), wc = edgeArea(a, b), area = wa + wb + wc;
    const double distance = (wa * a.z + wb * b.z + wc * c.z) / area;
    const glm::dvec3 normal = glm::cross(q - p, r - p);
    const double length = glm::length(normal);
    if (area == 0.0 || length == 0.0 || distance < 0.0) continue;
    hits.push_back({distance, normal * (side / length), f, -side});
  }
  std::ranges::sort(hits, [](const RayHit& l, const RayHit& r) {
    return l.distance != r.distance ? l.distance < r.distance : l.triangle < r.triangle;
  });
}

}  // namespace raymap::cpu
