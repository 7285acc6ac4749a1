#pragma once

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <string>

namespace raymap {

/// Most that the inner products of the axes differ from those of a rotation. Products of many
/// single-precision matrices stay below.
inline constexpr double kRigid = 1e-5;

/// Throws `Error(Usage)` unless the matrix is a rotation with a scale, and a translation. `nameOf` returns
/// its name for the message.
void checkPose(const glm::dmat4& pose, const std::function<std::string()>& nameOf);

// The functions below take such a matrix.

/// Returns the length in the world of one unit of the body: exactly 1 of a rigid motion.
inline double scaleOf(const glm::dmat4& pose) {
  const glm::dvec3 axis(pose[0]);
  const double squared = glm::dot(axis, axis);
  return std::abs(squared - 1.0) <= kRigid ? 1.0 : std::sqrt(squared);
}

inline glm::dvec3 moved(const glm::dmat4& pose, const glm::dvec3& p) {
  return glm::dvec3(pose[0]) * p.x + glm::dvec3(pose[1]) * p.y + glm::dvec3(pose[2]) * p.z +
         glm::dvec3(pose[3]);
}

/// Returns a direction turned; its length stays.
inline glm::dvec3 turned(const glm::dmat4& pose, const glm::dvec3& v) {
  return (glm::dvec3(pose[0]) * v.x + glm::dvec3(pose[1]) * v.y + glm::dvec3(pose[2]) * v.z) / scaleOf(pose);
}

/// Returns the point that the motion moves to `p`.
inline glm::dvec3 movedBack(const glm::dmat4& pose, const glm::dvec3& p) {
  const glm::dvec3 offset = p - glm::dvec3(pose[3]);
  const double scale = scaleOf(pose);
  return glm::dvec3(glm::dot(glm::dvec3(pose[0]), offset), glm::dot(glm::dvec3(pose[1]), offset),
                    glm::dot(glm::dvec3(pose[2]), offset)) /
         (scale * scale);
}

/// Returns the pose that takes the coordinates of a second pose's body to those of a first one's.
inline glm::dmat4 seenFrom(const glm::dmat4& pose, const glm::dmat4& other) {
  const double scale = scaleOf(pose);
  glm::dmat4 seen(glm::transpose(glm::dmat3(pose)) * glm::dmat3(other) / (scale * scale));
  seen[3] = glm::dvec4(movedBack(pose, glm::dvec3(other[3])), 1.0);
  return seen;
}

}  // namespace raymap
