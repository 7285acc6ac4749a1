#pragma once

#include <optional>

#include "picture/camera.h"
#include "picture/shape.h"

namespace raymap::cpu {

/// Returns the distance along a ray to where it first enters the shape, or nothing.
std::optional<double> trace(const Shape& shape, const Ray& ray);

/// Returns the share of a far, round light that reaches a point along `toLight`, 0 to 1.
double softShadow(const Shape& shape, const glm::dvec3& point, const glm::dvec3& toLight);

/// Returns the openness of a surface point's surroundings, from 0 (closed) to 1 (open).
double ambientOpenness(const Shape& shape, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace raymap::cpu
