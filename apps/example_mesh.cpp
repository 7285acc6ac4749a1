#include "example_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "implicit_mesh.h"

namespace raymap {

namespace {

using glm::dvec2;
using glm::dvec3;
using std::numbers::pi;

constexpr double kSpacing = 0.039, kFineSpacing = 0.0098;  // About 95,000 and 1.6 million triangles.

// Solids are functions that are negative inside. A union is a minimum, an intersection a maximum.

double unite(double a, double b) {
  return std::min(a, b);
}
double intersect(double a, double b) {
  return std::max(a, b);
}
double subtract(double a, double b) {
  return std::max(a, -b);
}

double slab(double x, double low, double high) {
  return std::max(low - x, x - high);
}

/// A prism around the y axis with `sides` sides, each at the distance `apothem`.
double prism(const dvec3& p, int sides, double apothem) {
  const double sector = 2.0 * pi / sides;
  const double angle = std::atan2(p.z, p.x);
  const double folded = angle - sector * std::round(angle / sector);
  return std::hypot(p.x, p.z) * std::cos(folded) - apothem;
}

double labyrinth(const dvec3& p) {
  constexpr double kWaves = 8.6;
  const dvec3 s = glm::sin(kWaves * p), c = glm::cos(kWaves * p);
  const double gyroid = s.x * c.y + s.y * c.z + s.z * c.x;
  return intersect((std::abs(gyroid) - 0.42) / kWaves, slab(glm::length(p), 0.62, 1.0));
}

/// The intersection of an octahedron and a cube.
double gem(const dvec3& p) {
  const dvec3 q = glm::abs(p);
  return intersect((q.x + q.y + q.z - 0.62) / std::sqrt(3.0), std::max({q.x, q.y, q.z}) - 0.4);
}

double toothedDisc(const dvec3& p) {
  const double radius = std::hypot(p.x, p.z);
  const double teeth = std::abs(std::fmod(std::atan2(p.z, p.x) / (2 * pi) * 36 + 36, 1.0) - 0.5) - 0.25;
  const double rim = 1.1 + 0.09 * std::clamp(0.5 + 8.0 * teeth, 0.0, 1.0);
  return intersect(slab(p.y, -0.035, 0.035), slab(radius, 0.93, rim) * 0.8);
}

/// A ring in the x-y plane whose square profile turns by 1.5 revolutions along it.
double twistedRing(const dvec3& p) {
  const double angle = std::atan2(p.y, p.x);
  const dvec2 q(std::hypot(p.x, p.y) - 1.36, p.z);
  const double turn = 1.5 * angle;
  const dvec2 r(std::cos(turn) * q.x + std::sin(turn) * q.y, std::cos(turn) * q.y - std::sin(turn) * q.x);
  return 0.9 * std::max(std::abs(r.x) - 0.085, std::abs(r.y) - 0.085);
}

double axle(const dvec3& p) {
  return intersect(std::hypot(p.x, p.z) - 0.055, slab(std::abs(p.y), 0.85, 1.55));
}

/// A thin ring to carry the globe by.
double handle(const dvec3& p) {
  const dvec3 q = p - dvec3(0, 1.72, 0);
  return std::hypot(std::hypot(q.x, q.y) - 0.19, q.z) - 0.04;
}

double column(const dvec3& p) {
  const double angle = std::atan2(p.z, p.x);
  const double radius = 0.2 + 0.25 * p.y * p.y + 0.025 * std::abs(std::cos(8 * angle));
  return 0.8 * intersect(std::hypot(p.x, p.z) - radius, slab(p.y, -0.5, 0.55));
}

double base(const dvec3& p) {
  const double steps = unite(intersect(prism(p, 6, 0.95), slab(p.y, -0.25, -0.05)),
                             intersect(prism(p, 12, 0.62), slab(p.y, -0.06, 0.09)));
  dvec3 q = p;
  const double sector = pi / 3, angle = std::atan2(p.z, p.x);
  const double folded = angle - sector * std::round(angle / sector);
  q.x = std::hypot(p.x, p.z) * std::cos(folded), q.z = std::hypot(p.x, p.z) * std::sin(folded);
  const double wells = std::hypot(q.x - 0.78, q.z) - 0.1;
  const double tunnel = std::hypot(p.y + 0.15, p.x) - 0.055;
  return subtract(subtract(steps, wells), tunnel);
}

double globe(const dvec3& p) {
  constexpr double kTilt = 23.4 * pi / 180.0;
  const dvec3 q(std::cos(kTilt) * p.x - std::sin(kTilt) * p.y, std::sin(kTilt) * p.x + std::cos(kTilt) * p.y,
                p.z);
  const double turning = std::min({labyrinth(q), gem(q), toothedDisc(q), twistedRing(q), axle(q), handle(q)});
  return std::min({turning, column(p - dvec3(0, -1.5, 0)), base(p - dvec3(0, -1.95, 0))});
}

/// Returns whether a point lies in one of the holes, which are scattered by the golden angle.
bool isTorn(const dvec3& p) {
  for (int hole = 0; hole < 40; ++hole) {
    const double y = 1.6 - 3.7 * (hole + 0.5) / 40;
    const double reach = y < -1.8 ? 0.8 : 0.5 + 0.5 * std::fmod(hole * 0.7548, 1.0);
    const double angle = hole * pi * (3.0 - std::sqrt(5.0));
    if (glm::distance(p, dvec3(reach * std::cos(angle), y, reach * std::sin(angle))) < 0.09) return true;
  }
  return false;
}

}  // namespace

Mesh makeExampleMesh(bool holes, bool isFine) {
  Mesh mesh = meshImplicit(globe, {{-1.7, -2.3, -1.3}, {1.7, 2.1, 1.3}}, isFine ? kFineSpacing : kSpacing);
  if (holes)
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
      return isTorn((mesh.position(t.x) + mesh.position(t.y) + mesh.position(t.z)) / 3.0);
    });
  return mesh;
}

}  // namespace raymap
