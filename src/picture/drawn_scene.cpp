#include "picture/drawn_scene.h"

#include <algorithm>
#include <limits>

namespace raymap {

RenderShape describe(const Shape& shape) {
  const glm::uvec3 dims(shape.field().grid().dims);
  return {
      .centre = shape.centre(),
      .radius = static_cast<float>(shape.radius()),
      .cutNormal = shape.isCut() ? glm::vec3(shape.cutNormal()) : glm::vec3(0.0f),
      .cutOffset = shape.isCut() ? static_cast<float>(shape.cutOffset()) : std::numeric_limits<float>::max(),
      .level = static_cast<float>(shape.level()),
      .wall = static_cast<float>(std::min(shape.wall(), kFarthestRay)),
      .band = static_cast<float>(std::min(shape.band(), kFarthestRay)),
      .innerBand = static_cast<float>(std::min(shape.innerBand(), kFarthestRay)),
      .nx = dims.x,
      .ny = dims.y,
      .nz = dims.z};
}

void move(const GridMotion& motion, RenderShape& shape, RenderSceneData& scene) {
  const auto turn = [&](glm::vec3& direction) { direction = glm::vec3(motion.turn * glm::dvec3(direction)); };
  const auto place = [&](glm::vec3& point) {
    point = glm::vec3(motion.turn * glm::dvec3(point) + motion.shift);
  };
  const auto plane = [&](glm::vec3& normal, float& offset) {
    turn(normal);
    offset += static_cast<float>(glm::dot(glm::dvec3(normal), motion.shift));
  };
  place(shape.centre);
  plane(shape.cutNormal, shape.cutOffset);  // Without a cut, the normal is 0.
  place(scene.eye);
  for (glm::vec3* direction : {&scene.right, &scene.up, &scene.forward, &scene.toLight}) turn(*direction);
  plane(scene.floorNormal, scene.floorHeight);
  plane(scene.sliceNormal, scene.sliceOffset);
}

RenderSceneData describe(const DrawnScene& scene) {
  const Camera& camera = scene.camera;
  return {.eye = camera.eye(),
          .right = camera.right(),
          .up = camera.up(),
          .forward = camera.forward(),
          .floorNormal = scene.up,
          .floorHeight = static_cast<float>(camera.floor()),
          .toLight = scene.toLight,
          .pixelAngle = static_cast<float>(camera.pixelAngle()),
          .lineStep = static_cast<float>(std::min(scene.lineStep, kFarthestRay * kFarthestRay)),
          .depth = static_cast<float>(std::min(scene.shape.depth(), kFarthestRay)),
          .sun = kSun,
          .sky = kSky,
          .bounce = kBounce,
          .clay = kClay,
          .top = kBackgroundTop,
          .bottom = kBackgroundBottom,
          .inside = {kInside[0], kInside[1], kInside[2]},
          .contour = kContour,
          .sliceNormal = scene.slice ? glm::vec3(scene.slice->normal) : glm::vec3(0.0f),
          .sliceOffset = scene.slice ? static_cast<float>(scene.slice->offset) : 0.0f,
          .sliceRange = static_cast<float>(std::min(scene.shape.radius(), kFarthestRay)),
          .outside = {kOutside[0], kOutside[1], kOutside[2]}};
}

RenderColours describeColours(const DrawnScene& scene) {
  RenderColours colours{};
  if (!scene.numbers) return colours;
  const Colouring& colouring = scene.numbers->colouring();
  colours.isDifference = scene.numbers->isDifference();
  colours.isOnSurface = colouring.isOnSurface;
  colours.lineStep = static_cast<float>(colouring.lineStep);
  colours.unknown = {glm::vec3(kNotFinite), 0.0f};
  colours.stopCount = static_cast<uint32_t>(colouring.stops.size());
  for (size_t s = 0; s < colouring.stops.size(); ++s)
    colours.stops[s] = {glm::vec3(colouring.stops[s].colour), static_cast<float>(colouring.stops[s].number)};
  return colours;
}

}  // namespace raymap
