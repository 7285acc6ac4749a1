#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// Removes what lies on the side of a plane to which its normal points, and closes the solid there with flat
/// faces. All else keeps its faces. Throws `Error(Input)` if the plane misses the mesh, and
/// `Error(Unsupported)` if no sound mesh comes out.
Mesh cutAway(const Mesh& solid, const Plane& plane);

}  // namespace raymap
