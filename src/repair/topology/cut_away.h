#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// Removes what lies on the side of a plane to which its normal points, and closes the solid there with flat
/// faces. All else keeps its faces. Throws `Error(Input)` if the plane misses the mesh, and
/// `Error(Unsupported)` if no sound mesh comes out. `sources` receives the
/// face of the solid that each face is a part of; those in the plane have larger numbers.
Mesh cutAway(const Mesh& solid, const Plane& plane, std::vector<uint32_t>& sources);

}  // namespace raymap
