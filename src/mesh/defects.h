#pragma once

#include <raymap/callbacks.h>

#include <cstdint>
#include <vector>

#include "mesh/patches.h"

namespace raymap {

/// Two vertices of the mesh. Each may be any of several at the same position.
struct EdgeEnds {
  uint32_t a, b;
};

/// Defects of a mesh, as `diagnose` and `findSelfIntersections` count them.
struct Defects {
  std::vector<EdgeEnds> boundaryEdges, nonManifoldEdges;
  std::vector<uint32_t> flippedFaces, duplicateFaces, doubleSidedFaces, degenerateFaces, crossedFaces;
  bool isComplete = true;  ///< False if the search for crossed faces stopped early.
};

/// Finds all defects. Throws `Error`: Input if the mesh is not valid, Cancelled.
Defects findDefects(const Model& mesh, const ProgressCallback& progress = {});

/// Returns the fewest faces to reverse so that neighbours across edges with two faces agree. It does not
/// matter which side is outside. Without `takesHalf`, none of patches where that is half of the faces.
std::vector<uint32_t> findFlippedFaces(const Patches& patches, bool takesHalf = true);

}  // namespace raymap
