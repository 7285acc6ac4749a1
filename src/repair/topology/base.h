#pragma once

#include <raymap/mesh.h>

#include <glm/glm.hpp>

namespace raymap {

/// Joins the rims of a mesh to a plane by walls along `down`. Equal positions of the mesh must be one vertex,
/// and its faces must agree. Turns open parts that point down, so that they point up. The plane is `base`
/// from the origin of the coordinates against `down`, which must not be 0.
///
/// Throws `Error(Input)` if there is no rim, if one does not close, or if the mesh reaches below the plane.
void joinToBase(Mesh& mesh, double base, const glm::dvec3& down);

}  // namespace raymap
