#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/model.h"

namespace raymap {

/// A mesh without its degenerate and repeated faces.
struct CleanedFaces {
  Mesh mesh = {};  ///< Welded. Sound faces keep their corners and their order.
  /// Given face that each face is, or lies in: where an edge was flipped, the sound one of two.
  std::vector<uint32_t> given = {};
  size_t count = 0;  ///< Number of faces that were removed or replaced with a neighbour.
};

/// How much `cleanFaces` removes.
enum class Cleaning : uint8_t {
  Repeated,    ///< Repeated faces, and those with a repeated corner.
  Degenerate,  ///< All degenerate faces, too.
  Rounded      ///< The same where corners are rounded.
};

/// Leaves out faces with a repeated corner, repeated ones that close nothing, and the other side of faces
/// that the surface around them needs once. Welds the ends of edges shorter than 1e-6 of the longest edge of
/// a degenerate face. Flips the longest edge of the other degenerate faces, which moves no surface by more
/// than their height, unless that leaves a degenerate face. If corners are rounded, welds edges of degenerate
/// faces of up to 1e-5 of the longest, or of 1e-6 of the mesh, those of all faces of up to 1.5e-7 of it, and
/// flips edges between two degenerate faces, too: more faces go, but others may cross then. Faces that stay
/// degenerate become just high enough.
CleanedFaces cleanFaces(const Model& mesh, Cleaning how = Cleaning::Degenerate);

/// Returns the given faces of some faces of a cleaned mesh, ascending.
std::vector<uint32_t> facesOf(const std::vector<uint32_t>& faces, const std::vector<uint32_t>& given);

/// Moves the apex of degenerate faces away from their longest edge, until they are just high enough.
void raiseDegenerate(Mesh& mesh);

/// Moves the apex of faces that are lower than rounding may move a vertex, so that rounding may have turned
/// them over: those that share a corner with faces that cross others. They rise by as much as two roundings.
void raiseLowFaces(Mesh& mesh, const std::vector<uint32_t>& crossing);

}  // namespace raymap
