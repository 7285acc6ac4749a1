#pragma once

#include <optional>

#include "scene/camera.h"
#include "scene/shape.h"

namespace raymap {

/// Where a ray first enters the shape, as the distance along it.
std::optional<double> trace(const Shape& shape, const Ray& ray);

/// The share of a far, round light that reaches a point along `toLight`, 0 to 1.
double softShadow(const Shape& shape, const glm::dvec3& point, const glm::dvec3& toLight);

/// How open the surroundings of a surface point are, 0 to 1.
double ambientOpenness(const Shape& shape, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace raymap
