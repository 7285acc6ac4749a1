#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// An edge of a rim in the direction in which a face of the hole uses it, and the third corner of its face.
struct BorderEdge {
  uint32_t from, to, third;
};

/// A closed loop of border edges.
using Rim = std::vector<BorderEdge>;

/// The rims of a mesh.
struct Rims {
  std::vector<Rim> closed;
  std::vector<uint32_t> open;  ///< A vertex of each chain of border edges that does not close.
};

/// Edges that make rims.
enum class BorderEdges : uint8_t {
  OneFace,    ///< Those of one face.
  Unbalanced  ///< Those that faces use more often in one direction than in the other. All of their rims
              ///< close.
};

/// Finds the rims of a mesh whose equal positions are one vertex.
Rims findRims(const Mesh& mesh, BorderEdges which = BorderEdges::OneFace);

}  // namespace raymap
