#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

namespace raymap {

/// Rows of an affine transform. The product of a row with (x, y, z, 1) is one coordinate of the moved point.
struct JointMatrix {
  glm::vec4 rows[3] = {};
};
static_assert(sizeof(glm::vec4) == 16 && sizeof(JointMatrix) == 48);
static_assert(sizeof(glm::u16vec4) == 8);

/// A mesh whose vertices follow joints (linear-blend skinning), and their motion, as in a glTF file.
///
/// Morphs move a vertex first. It then moves to the sum of weight * matrix * position over its four joints. A
/// part without a skin follows one joint with weight 1. Programs may make their own.
struct AnimatedMesh {
  /// A transform that other nodes build on: the parent's, then translation * rotation * scale * matrix.
  struct Node {
    int parent = -1;  ///< Index of an earlier node; -1 = none.
    glm::dvec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    glm::dvec3 scale{1.0};
    glm::dmat4 matrix{1.0};
  };
  struct Joint {
    uint32_t node = 0;            ///< Index of the node that it follows.
    glm::dmat4 inverseBind{1.0};  ///< Transform from rest positions to the node's coordinates.
  };
  /// Offsets of consecutive vertices of `rest`, which are added times a weight (a morph target).
  struct Morph {
    double weight = 0.0;  ///< Weight unless a track moves it.
    uint32_t firstVertex = 0;
    std::vector<glm::vec3> offsets = {};
  };
  /// One property of a node, or the weight of a morph, over time. It keeps its first value before the first
  /// time, its last value after the last.
  struct Track {
    enum class Target { Translation, Rotation, Scale, Weight };
    enum class Interpolation { Step, Linear, CubicSpline };
    uint32_t node = 0;  ///< Index of the node; of the morph, if the target is its weight.
    Target target = Target::Translation;
    Interpolation interpolation = Interpolation::Linear;
    std::vector<double> times = {};  ///< Seconds, never descending.
    /// One value per time; for a cubic spline three: the tangent before, the value, the tangent after.
    /// Rotations are quaternions (x, y, z, w). A weight is x.
    std::vector<glm::dvec4> values = {};
  };

  Mesh rest = {};                         ///< Mesh before any joint moves it.
  std::vector<glm::u16vec4> joints = {};  ///< Four indices into `skeleton` per vertex.
  std::vector<glm::vec4> weights = {};    ///< Four weights per vertex, which should add up to 1.
  std::vector<Node> nodes = {};
  std::vector<Joint> skeleton = {};
  std::vector<Track> tracks = {};
  std::vector<Morph> morphs = {};
  glm::dvec3 origin{0.0};  ///< Origin of the moved mesh, at any time.
  /// Names of all animations of the file that it was read from; the number of one without a name.
  std::vector<std::string> clips = {};

  /// Returns the time at which the last track ends, in seconds.
  RAYMAP_API double seconds() const;
};

/// Throws `Error(Input)` that names the element and the value if anything refers to what does not exist.
RAYMAP_API void validate(const AnimatedMesh& mesh);

/// Returns the weight of every morph.
RAYMAP_API std::vector<double> morphWeights(const AnimatedMesh& mesh, double seconds);

/// Returns one matrix per joint of the skeleton. It takes vertices of `rest`, moved by the morphs, to
/// vertices about `origin`.
RAYMAP_API std::vector<JointMatrix> jointMatrices(const AnimatedMesh& mesh, double seconds);

/// Returns the mesh at a time, moved by the CPU.
RAYMAP_API Mesh posed(const AnimatedMesh& mesh, double seconds);
/// Does the same, reusing the memory of `result`.
RAYMAP_API void posed(const AnimatedMesh& mesh, double seconds, Mesh& result);

}  // namespace raymap
