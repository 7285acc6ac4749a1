#pragma once

#include <raymap/buffer.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// How the sign takes each face: as given, with reversed winding order, or not at all.
using Turns = std::vector<uint8_t>;
inline constexpr uint8_t kAsGiven = 0, kReversed = 1, kLeftOut = 2;

/// Returns the face as the sign takes it. A face that is left out becomes a point.
inline glm::uvec3 turned(const glm::uvec3& face, uint8_t turn) {
  if (turn == kLeftOut) return glm::uvec3(face.x);
  return turn == kReversed ? glm::uvec3(face.x, face.z, face.y) : face;
}

/// Returns faces as the sign takes them. `turns` is empty if it takes all as given.
inline Buffer<glm::uvec3> turnedTriangles(std::span<const glm::uvec3> given, const Turns& turns) {
  Buffer<glm::uvec3> triangles;
  triangles.resizeUninitialized(given.size());
  for (size_t f = 0; f < given.size(); ++f)
    triangles[f] = turned(given[f], turns.empty() ? kAsGiven : turns[f]);
  return triangles;
}

}  // namespace raymap
