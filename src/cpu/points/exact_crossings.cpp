#include "cpu/points/exact_crossings.h"

#include <cmath>

#include "cpu/points/segment_crossings.h"

namespace raymap::cpu {

namespace {

/// Returns the sign of the volume of the parallelepiped of three vectors, or 0 if rounding could change it.
int signOfVolume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  constexpr double kRounding = 1e-14;
  const double volume = glm::dot(glm::cross(a, b), c);
  const double bound = kRounding * std::sqrt(glm::dot(a, a) * glm::dot(b, b) * glm::dot(c, c));
  if (std::abs(volume) <= bound) return 0;
  return volume > 0.0 ? 1 : -1;
}

/// Returns the change of the winding number where the segment crosses a face, or `kUnsure`.
int32_t crossingOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                   const glm::dvec3& to) {
  const glm::dvec3 along = to - from, fa = a - from, fb = b - from, fc = c - from;
  const int ab = signOfVolume(fa, fb, along), bc = signOfVolume(fb, fc, along),
            ca = signOfVolume(fc, fa, along);
  const bool isLeft = ab > 0 || bc > 0 || ca > 0, isRight = ab < 0 || bc < 0 || ca < 0;
  if (isLeft && isRight) return 0;  // The line passes beside the face.
  const glm::dvec3 normalA = b - a, normalB = c - a;
  const int start = signOfVolume(normalA, normalB, from - a), end = signOfVolume(normalA, normalB, to - a);
  if (start * end > 0) return 0;
  return ab * bc * ca * start * end == 0 ? kUnsure : start;
}

}  // namespace

int32_t countCrossingsExactly(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                              const glm::dvec3& from, const glm::dvec3& to) {
  int32_t sum = 0;
  for (const uint32_t f : faces) {
    const uint8_t turn = turns.empty() ? kAsGiven : turns[f];
    if (turn == kLeftOut) continue;
    const glm::uvec3 face = turned(mesh.triangles[f], turn);
    const glm::dvec3 a(mesh.vertices[face.x]), b(mesh.vertices[face.y]), c(mesh.vertices[face.z]);
    if (glm::cross(b - a, c - a) == glm::dvec3(0.0)) continue;
    const int32_t crossing = crossingOf(a, b, c, from, to);
    if (crossing == kUnsure) return kUnsure;
    sum += crossing;
  }
  return sum;
}

}  // namespace raymap::cpu
