#pragma once

#include <raymap/mesh.h>

#include <functional>

namespace raymap {

/// Returns a closed mesh of the zero set of `implicit` (negative inside), on cubes of side `spacing` in
/// `box`. Each cube gets one vertex where the tangent planes at its crossed edges meet, so that sharp edges
/// stay sharp (dual contouring, Ju et al. 2002). The solid must not touch the box's sides.
/// docs/dev/decisions/implicit_mesh.md says why `raymap::isosurface` does not do this.
Mesh meshImplicit(const std::function<double(const glm::dvec3&)>& implicit, const Box& box, double spacing);

}  // namespace raymap
