#pragma once

#include <raymap/mesh.h>

#include <cstddef>

namespace raymap {

/// Number of holes that were filled, and of the faces that fill them.
struct FilledHoles {
  size_t holes = 0, faces = 0;
  size_t twistedFaces = 0;  ///< The last of them, in holes at edges where faces contradict each other.
};

/// Appends faces that close all holes of a mesh whose equal positions are one vertex. Each hole gets the
/// triangulation of its rim whose sharpest edge is least sharp, and the least area among those (Liepa 2003).
/// Holes end at edges that faces use more often in one direction than in the other, so no such edge is left.
/// Of a rim with more than 300 edges, about 150 vertices are joined in this way first; then each of these
/// faces is replaced by those that fill the rim through all vertices between its corners. The new faces may
/// cross others.
FilledHoles fillHoles(Mesh& mesh);

}  // namespace raymap
