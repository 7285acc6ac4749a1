#include "cpu/render/shade.h"

#include <algorithm>
#include <cmath>

#include "cpu/render/sphere_trace.h"
#include "picture/shade_shared.h"

namespace raymap::cpu {

namespace {

/// Returns the share of light that the shape leaves on the floor, for a ray that misses the shape.
double floorShade(const DrawnScene& scene, const Ray& ray) {
  const double down = -glm::dot(ray.direction, scene.up);
  const double t = (glm::dot(ray.origin, scene.up) - scene.camera.floor()) / down;
  if (!(down > 1e-6) || !(t > 0.0) || !std::isfinite(t)) return 1.0;
  const glm::dvec3 p = ray.origin + t * ray.direction;
  const double sun = softShadow(scene.shape, p, scene.toLight);
  const double sky = ambientOpenness(scene.shape, p, scene.up);
  return (kFloorInShadow + kFloorSun * sun) * (kFloorOccluded + kFloorSky * sky);
}

/// Draws lines over the ground where the field has a distance: iso-lines, and the surface's own. What is only
/// known to be far has none.
Colour drawLines(const DrawnScene& scene, const Colour& ground, double d, double slope) {
  if (scene.shape.isClamped(d)) return ground;
  return drawContour(drawIsoLines(ground, d, slope, scene.lineStep), d, slope, kContour);
}

/// Returns the colour of the cut face. It is drawn like a slice, without lights, and is only darkened by
/// occlusion.
Colour cutFace(const DrawnScene& scene, const glm::dvec3& p, const glm::dvec3& n, double t) {
  const double d = scene.shape.fieldDistance(p);
  const Colour ground = distanceColour(std::min(d, -1e-9), scene.shape.depth());
  return (kCutOccluded + kCutSky * ambientOpenness(scene.shape, p, n)) *
         drawLines(scene, ground, d, t * scene.camera.pixelAngle());
}

/// Returns the colour of a number at a point inside. `pixel` is a pixel's size there. Lines lie half a step
/// off zero: large regions have whole numbers.
Colour numberColour(const DrawnScene& scene, const glm::dvec3& p, double pixel) {
  const ShownNumbers& numbers = *scene.numbers;
  const Colouring& colouring = numbers.colouring();
  const double number = numbers.at(p);
  if (std::isnan(number)) return kNotFinite;
  glm::dvec3 gradient;
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 step(0.0);
    step[a] = 0.5;
    gradient[a] = numbers.at(p + step) - numbers.at(p - step);
  }
  const double slope = pixel * glm::length(gradient);
  Colour ground = colouring.at(number);
  if (slope > kPlainValues * pixel * colouring.lineStep)
    ground = drawIsoLines(ground, number - 0.5 * colouring.lineStep, slope, colouring.lineStep);
  const double d = scene.shape.fieldDistance(p);
  return scene.shape.isClamped(d) ? ground : drawContour(ground, d, pixel, kContour);
}

Colour surface(const DrawnScene& scene, const Ray& ray, double t) {
  const glm::dvec3 p = ray.origin + t * ray.direction;
  const glm::dvec3 n = scene.shape.normal(p);
  if (scene.shape.isOnCutFace(p))
    return scene.numbers ? numberColour(scene, p, t * scene.camera.pixelAngle()) : cutFace(scene, p, n, t);
  const bool isColoured = scene.numbers && scene.numbers->colouring().isOnSurface;
  const Colour clay = isColoured ? scene.numbers->colouring().at(scene.numbers->at(p)) : kClay;
  const double facing = glm::dot(n, scene.toLight);
  const double sun = facing > 0.0 ? facing * softShadow(scene.shape, p + n, scene.toLight) : 0.0;
  const double open = ambientOpenness(scene.shape, p, n);
  const double upward = 0.5 + 0.5 * glm::dot(n, scene.up);
  const Colour incoming = sun * kSun + open * (upward * kSky + (1.0 - upward) * kBounce);
  const double grazing = std::pow(1.0 - std::clamp(-glm::dot(n, ray.direction), 0.0, 1.0), kGrazingPower);
  const double shine =
      std::pow(std::max(glm::dot(n, glm::normalize(scene.toLight - ray.direction)), 0.0), kShinePower) *
      (sun > 0.0 ? sun : 0.0);
  const Colour lit =
      kDiffusePart * clay * incoming + kGrazingPart * grazing * open * kSky + kShinePart * shine * kSun;
  return lit * (1.0 + lit / kWhite) / (1.0 + lit);
}

/// Returns the distance along a ray to where it meets the slice inside the grid, or nothing.
std::optional<double> traceSlice(const DrawnScene& scene, const Ray& ray) {
  if (!scene.slice) return {};
  const double across = glm::dot(ray.direction, scene.slice->normal);
  const double t = (scene.slice->offset - glm::dot(ray.origin, scene.slice->normal)) / across;
  const glm::dvec3 p = ray.origin + t * ray.direction, last = scene.shape.field().last();
  const bool isInGrid =
      glm::all(glm::greaterThanEqual(p, glm::dvec3(-0.5))) && glm::all(glm::lessThanEqual(p, last + 0.5));
  if (!(t >= 0.0) || !isInGrid) return {};
  return t;
}

Colour sliceColour(const DrawnScene& scene, const glm::dvec3& p, double slope) {
  if (scene.numbers) return numberColour(scene, p, slope);
  const double d = scene.shape.fieldDistance(p);
  const Colour ground = distanceColour(d, d < 0.0 ? scene.shape.depth() : scene.shape.radius());
  return drawLines(scene, ground, d, slope);
}

/// Returns the light along a ray. `y` is the ray's row in the picture.
Colour light(const DrawnScene& scene, const Ray& ray, double y) {
  const std::optional<double> t = trace(scene.shape, ray), slice = traceSlice(scene, ray);
  if (slice && !(t && *t <= *slice))
    return sliceColour(scene, ray.origin + *slice * ray.direction, *slice * scene.camera.pixelAngle());
  if (t) return surface(scene, ray, *t);
  return glm::mix(kBackgroundTop, kBackgroundBottom, y / scene.camera.height()) * floorShade(scene, ray);
}

}  // namespace

Colour pixelColour(const DrawnScene& scene, int x, int y) {
  Colour sum(0.0);
  for (const glm::dvec2& s : kSubPixels) sum += light(scene, scene.camera.ray(x + s.x, y + s.y), y + s.y);
  return 0.25 * sum;
}

}  // namespace raymap::cpu
