#pragma once

#include <raymap/mesh.h>
#include <raymap/mesh_view.h>

#include <cstddef>

namespace raymap {

/// Joins rims that lie next to each other, vertex to vertex, in a mesh whose equal positions are one vertex:
/// of two vertices that are each other's nearest on rims, all faces take the lower one. They may be apart by
/// a quarter of the edges on their rims, and by `widest`. Leaves rims as they are if that takes too much
/// work. Returns how many vertices went.
size_t sewCracks(Mesh& mesh, double widest);

/// Returns the widest crack of a mesh to join by default: 0.2 % of its diagonal.
double widestCrack(const MeshView& mesh);

}  // namespace raymap
