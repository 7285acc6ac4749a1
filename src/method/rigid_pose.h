#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>

namespace raymap {

/// Throws `Error(Usage)` unless the matrix is a rigid motion. `nameOf` returns its name for the message.
void checkRigid(const glm::dmat4& pose, const std::function<std::string()>& nameOf);

// The functions below take a rigid motion.

inline glm::dvec3 moved(const glm::dmat4& pose, const glm::dvec3& p) {
  return glm::dvec3(pose[0]) * p.x + glm::dvec3(pose[1]) * p.y + glm::dvec3(pose[2]) * p.z +
         glm::dvec3(pose[3]);
}

inline glm::dvec3 turned(const glm::dmat4& pose, const glm::dvec3& v) {
  return glm::dvec3(pose[0]) * v.x + glm::dvec3(pose[1]) * v.y + glm::dvec3(pose[2]) * v.z;
}

/// Returns the point that the motion moves to `p`.
inline glm::dvec3 movedBack(const glm::dmat4& pose, const glm::dvec3& p) {
  const glm::dvec3 offset = p - glm::dvec3(pose[3]);
  return {glm::dot(glm::dvec3(pose[0]), offset), glm::dot(glm::dvec3(pose[1]), offset),
          glm::dot(glm::dvec3(pose[2]), offset)};
}

/// Returns the pose that takes the coordinates of a second pose's body to those of a first one's.
inline glm::dmat4 seenFrom(const glm::dmat4& pose, const glm::dmat4& other) {
  glm::dmat4 seen(glm::transpose(glm::dmat3(pose)) * glm::dmat3(other));
  seen[3] = glm::dvec4(movedBack(pose, glm::dvec3(other[3])), 1.0);
  return seen;
}

}  // namespace raymap
