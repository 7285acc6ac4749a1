#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace raymap {

/// The rows of an affine transform: each times (x, y, z, 1) gives one coordinate of the moved point.
struct JointMatrix {
  glm::vec4 rows[3];
};

/// A mesh whose vertices follow joints (linear-blend skinning), and how these move: what a glTF file holds.
///
/// A vertex goes to the sum of weight * matrix * rest position over its four joints. A part that no skin
/// moves follows one joint with weight 1. Nothing else about it is special, so programs may make their own.
struct AnimatedMesh {
  /// A place that others hang on. Its transform is translation * rotation * scale * matrix, after its
  /// parent's.
  struct Node {
    int parent = -1;  ///< Among `nodes`, before this one; -1 = none.
    glm::dvec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    glm::dvec3 scale{1.0};
    glm::dmat4 matrix{1.0};
  };
  struct Joint {
    uint32_t node = 0;
    glm::dmat4 inverseBind{1.0};  ///< From the place of rest positions to the node's.
  };
  /// One value of a node over time. It keeps its first value before the first time, its last after the last.
  struct Track {
    enum class Target { Translation, Rotation, Scale };
    enum class Interpolation { Step, Linear, CubicSpline };
    uint32_t node = 0;
    Target target = Target::Translation;
    Interpolation interpolation = Interpolation::Linear;
    std::vector<double> times;  ///< Seconds, never descending.
    /// One a time, three of a cubic spline: the tangent before, the value, the tangent after. Rotations are
    /// quaternions (x, y, z, w).
    std::vector<glm::dvec4> values;
  };

  Mesh rest;                         ///< As stored, before any joint moves it.
  std::vector<glm::u16vec4> joints;  ///< Four of each vertex, among `skeleton`,
  std::vector<glm::vec4> weights;    ///< and how much each counts. They should add up to 1.
  std::vector<Node> nodes;
  std::vector<Joint> skeleton;
  std::vector<Track> tracks;
  glm::dvec3 origin{0.0};  ///< Of the moved mesh, at any time.

  /// When the last track ends.
  double seconds() const;
};

/// Throws `Error(Input)` that names the element and the value if anything refers to what does not exist.
void validate(const AnimatedMesh& mesh);

/// A matrix for each joint of the skeleton: takes vertices of `rest` to vertices about `origin`.
std::vector<JointMatrix> jointMatrices(const AnimatedMesh& mesh, double seconds);

/// The mesh at a time, moved by the CPU.
Mesh posed(const AnimatedMesh& mesh, double seconds);

}  // namespace raymap
