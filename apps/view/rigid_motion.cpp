#include "rigid_motion.h"

#include <raymap/mesh_view.h>

#include <algorithm>
#include <glm/gtc/matrix_inverse.hpp>

namespace raymap::view {

namespace {

// Largest error of a vertex: as a share of the mesh's size, and of its distance from the origin of the poses,
// of which matrices of single precision know no more.
constexpr double kOfSize = 1e-5, kOfDistance = 1e-6;

glm::dmat4 matrixOf(const JointMatrix& joint) {
  return glm::transpose(glm::dmat4(glm::dvec4(joint.rows[0]), glm::dvec4(joint.rows[1]),
                                   glm::dvec4(joint.rows[2]), glm::dvec4(0.0, 0.0, 0.0, 1.0)));
}

bool areEqual(const JointMatrix& a, const JointMatrix& b) {
  return std::ranges::equal(a.rows, b.rows);
}

}  // namespace

RigidPoses::RigidPoses(const AnimatedMesh& mesh) : mesh_(mesh) {
  std::vector<bool> moves(mesh.skeleton.size());
  for (size_t v = 0; v < mesh.joints.size(); ++v)
    for (int k = 0; k < 4; ++k)
      if (mesh.weights[v][k] != 0.0F) moves[mesh.joints[v][k]] = true;
  for (size_t j = 0; j < moves.size(); ++j)
    if (moves[j]) joints_.push_back(j);
  const Box box = bounds(mesh.rest);
  for (size_t c = 0; c < corners_.size(); ++c)
    corners_[c] = glm::dvec3(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y,
                             c & 4 ? box.max.z : box.min.z) -
                  mesh.rest.origin;
  size_ = glm::length(box.size());
}

std::optional<RigidMotion> RigidPoses::between(double from, double to) const {
  if (joints_.empty() || morphWeights(mesh_, from) != morphWeights(mesh_, to)) return {};
  const std::vector<JointMatrix> before = jointMatrices(mesh_, from), after = jointMatrices(mesh_, to);
  if (std::ranges::all_of(joints_, [&](size_t j) { return areEqual(before[j], after[j]); }))
    return RigidMotion{};
  // The motion of the first joint must be that of all.
  const glm::dmat4 first = matrixOf(after[joints_[0]]) * glm::inverse(matrixOf(before[joints_[0]]));
  const glm::dquat rotation = glm::normalize(glm::quat_cast(glm::dmat3(first)));
  const glm::dvec3 shift(first[3]);
  for (const size_t j : joints_)
    for (const glm::dvec3& corner : corners_) {
      const glm::dvec3 here(matrixOf(before[j]) * glm::dvec4(corner, 1.0));
      const glm::dvec3 there(matrixOf(after[j]) * glm::dvec4(corner, 1.0));
      const double most = kOfSize * size_ + kOfDistance * (glm::length(here) + glm::length(there));
      if (!(glm::distance(rotation * here + shift, there) <= most)) return {};
    }
  const glm::dvec3& origin = mesh_.origin;  // Origin of the matrices.
  return RigidMotion{.rotation = rotation, .translation = origin + shift - rotation * origin};
}

}  // namespace raymap::view
