#pragma once

#include <raymap/field.h>

#include <functional>

#include "plane_fit.h"
#include "progress.h"

namespace raymap {

/// Tells a fit, in samples, how the surface lies where it crosses the lattice edge between two samples: at
/// least one `addCrossing`. Called by any thread. `outside` may lie a step outside of the grid.
using AddPlanes = std::function<void(const glm::ivec3& inside, const glm::ivec3& outside, PlaneFit& fit)>;

/// The surface of the solid whose samples are below `iso`; what lies outside of the grid is outside. Every
/// edge has exactly two faces, which agree in orientation, and the faces around each vertex make one disc,
/// whatever the samples. Faces cross only where two sheets pass a cube too close to each other. Throws
/// `Error(Memory)` or `Error(Unsupported)` if it has too many vertices.
Mesh dualContour(const Field& field, double iso, const AddPlanes& addPlanes, Progress& progress);

}  // namespace raymap
