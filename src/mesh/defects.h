#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// Two vertices of the mesh; of several at the same position, any.
struct EdgeEnds {
  uint32_t a, b;
};

/// Where a mesh is broken, as `diagnose` and `findSelfIntersections` count it.
struct Defects {
  std::vector<EdgeEnds> boundaryEdges, nonManifoldEdges;
  std::vector<uint32_t> flippedFaces, duplicateFaces, crossedFaces;
};

Defects findDefects(const Mesh& mesh);

/// The fewest faces to turn so that neighbours across edges with two faces agree. Which side is out nobody
/// asks.
std::vector<uint32_t> findFlippedFaces(const Mesh& mesh);

}  // namespace raymap
