#pragma once

#include <raymap/mesh.h>

#include <functional>

namespace raymap {

/// A closed mesh of the zero set of `implicit` (negative inside) on cubes of side `spacing` in `box`, one
/// vertex a cube where the tangent planes of its edges meet: sharp edges stay sharp (dual contouring, Ju et
/// al. 2002). The solid must not touch the box's sides.
Mesh meshImplicit(const std::function<double(const glm::dvec3&)>& implicit, const Box& box, double spacing);

}  // namespace raymap
