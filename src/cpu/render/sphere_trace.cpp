// Sphere tracing: J. C. Hart, "Sphere tracing: a geometric method for the antialiased ray tracing of implicit
// surfaces", The Visual Computer 12 (1996). A distance is how far a ray may go without meeting a surface.
//
// Shadows and occlusion use the same distances, after ideas of Í. Quílez. Where the distance a little above a
// surface is less than the height, something is near. The narrowest angle by which a ray to the light passes
// everything gives the covered share of a round light.

#include "cpu/render/sphere_trace.h"

#include <algorithm>

#include "picture/sphere_trace_shared.h"

namespace raymap::cpu {

namespace {

/// Returns the part of the ray inside a ball around the shape: {first, last}, empty if last < first.
glm::dvec2 clipToBall(const Shape& shape, const Ray& ray) {
  const glm::dvec3 toCentre = shape.centre() - ray.origin;
  const double radius = shape.radius() + kBallMargin;
  const double middle = glm::dot(toCentre, ray.direction);
  const double half2 = radius * radius - (glm::dot(toCentre, toCentre) - middle * middle);
  if (half2 <= 0.0) return {0.0, -1.0};
  const double half = std::sqrt(half2);
  return {std::max(middle - half, 0.0), middle + half};
}

/// Returns the position of the surface between `outside` and `inside` along the ray. Secant and bisection
/// steps alternate, so the search converges even if the value bends or jumps.
double refineHit(const Shape& shape, const Ray& ray, double outside, double inside, double dOut, double dIn) {
  for (int i = 0; i < kHitSteps && inside - outside > kHitTolerance; ++i) {
    const double share = i % 2 == 0 ? std::clamp(dOut / (dOut - dIn), kLeastSecant, kMostSecant) : 0.5;
    const double t = outside + share * (inside - outside);
    const double d = shape.distance(ray.origin + t * ray.direction);
    if (std::abs(d) < kHitTolerance) return t;
    (d > 0.0 ? outside : inside) = t;
    (d > 0.0 ? dOut : dIn) = d;
  }
  return inside;
}

}  // namespace

std::optional<double> trace(const Shape& shape, const Ray& ray) {
  const glm::dvec2 part = clipToBall(shape, ray);
  double before = part.x, dBefore = INFINITY;
  for (double t = part.x; t <= part.y;) {
    const glm::dvec3 p = ray.origin + t * ray.direction;
    const double d = shape.distance(p);
    if (d <= 0.0) return t > part.x ? refineHit(shape, ray, before, t, dBefore, d) : t;
    before = t;
    dBefore = d;
    t += std::max(shape.step(p, ray.direction, d), kLeastStep);
  }
  return std::nullopt;
}

double softShadow(const Shape& shape, const glm::dvec3& point, const glm::dvec3& toLight) {
  const Ray ray{point, toLight};
  const glm::dvec2 part = clipToBall(shape, ray);
  double clear = 1.0;  // Narrowest angle so far, divided by the light's.
  double dBefore = kNothingNear, stepped = 1.0;
  for (double t = std::max(part.x, kShadowStart); t <= part.y;) {
    const glm::dvec3 p = point + t * toLight;
    const double d = shape.distance(p);
    if (d <= 0.0) return 0.0;
    // Steps straddle the narrowest place at random, which would leave ripples. Two distances a step apart
    // give its position and width between them if the surface there is flat.
    const double back = (stepped * stepped + d * d - dBefore * dBefore) / (2.0 * stepped);
    const bool isBetween = back > 0.0 && back < std::min(stepped, d);
    const double narrowest =
        shape.openDistance(p) * (isBetween ? std::sqrt(1.0 - back * back / (d * d)) : 1.0);
    clear = std::min(clear, narrowest / (kLightSize * (isBetween ? t - back : t)));
    if (clear < kDark) return 0.0;
    stepped = std::max(shape.step(p, toLight, d), 4 * kLeastStep);
    dBefore = stepped > std::max(d, 4 * kLeastStep) ? kNothingNear : d;  // A plateau's distance says nothing.
    t += stepped;
  }
  return clear * clear * (3.0 - 2.0 * clear);
}

double ambientOpenness(const Shape& shape, const glm::dvec3& point, const glm::dvec3& normal) {
  double blocked = 0.0, weight = 1.0, total = 0.0;
  for (const double share : kHeightShares) {
    const double height = share * shape.radius();
    const double open = shape.openDistance(point + height * normal);
    blocked += weight * std::clamp(1.0 - open / height, 0.0, 1.0);
    total += weight;
    weight *= kHeightFading;
  }
  return std::max(1.0 - kOcclusion * blocked / total, 0.0);
}

}  // namespace raymap::cpu
