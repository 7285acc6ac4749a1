#include "simplify/plane_quadric.h"

#include <algorithm>

namespace raymap {

void PlaneQuadric::addPlane(const glm::dvec3& n, const glm::dvec3& point, double weight) {
  const double d = -glm::dot(n, point);
  xx += weight * n.x * n.x, xy += weight * n.x * n.y, xz += weight * n.x * n.z;
  yy += weight * n.y * n.y, yz += weight * n.y * n.z, zz += weight * n.z * n.z;
  x += weight * d * n.x, y += weight * d * n.y, z += weight * d * n.z;
  one += weight * d * d;
}

void PlaneQuadric::add(const PlaneQuadric& other) {
  xx += other.xx, xy += other.xy, xz += other.xz, yy += other.yy, yz += other.yz, zz += other.zz;
  x += other.x, y += other.y, z += other.z, one += other.one;
}

double PlaneQuadric::meanSquare(const glm::dvec3& p) const {
  const double weight = xx + yy + zz;  // Normals have length 1.
  const double sum = p.x * (xx * p.x + 2.0 * (xy * p.y + xz * p.z + x)) +
                     p.y * (yy * p.y + 2.0 * (yz * p.z + y)) + p.z * (zz * p.z + 2.0 * z) + one;
  return weight > 0.0 ? std::max(sum, 0.0) / weight : 0.0;
}

}  // namespace raymap
