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
/// A rim with more than 300 edges is filled in two steps. First, faces join about 150 of its vertices. Then
/// the rim through all vertices between the corners of each of these faces is filled in its place. The new
/// faces may cross others.
FilledHoles fillHoles(Mesh& mesh);

}  // namespace raymap
