#pragma once

#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "io/gltf/gltf_document.h"
#include "io/gltf/gltf_draco.h"

namespace raymap {

/// The default scene of a glTF file: its nodes and the surfaces of its meshes.
class GltfScene {
 public:
  using Json = GltfDocument::Json;

  struct Node {
    uint64_t index = 0;  ///< Index among the file's nodes.
    int parent = -1;     ///< Index of an earlier node of the scene; -1 for none.
    const Json* json = nullptr;
    bool isVisible = true;
  };

  /// The primitives of a mesh that consist of triangles and have positions.
  struct Surfaces {
    std::vector<const Json*> list;
    uint64_t others = 0;                 ///< Number of primitives of points or lines.
    uint64_t vertices = 0, corners = 0;  ///< Those of the list, all together.
  };

  /// A place of an instance, relative to its node.
  struct Placement {
    glm::dvec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    glm::dvec3 scale{1.0};
    glm::dmat4 matrix() const;
  };

  /// Fails if the file requires an extension that may change shapes and is not read, or its nodes do not form
  /// trees.
  explicit GltfScene(const MeshFile& file);

  const GltfDocument& document() const { return document_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Returns `count` numbers of a node, or none if the key is missing.
  std::vector<double> numbers(const Node& node, const char* key, size_t count) const;
  /// Returns a node's transform, relative to its parent.
  glm::dmat4 transform(const Node& node) const;
  /// Returns the transform of every node to the scene.
  std::vector<glm::dmat4> worldTransforms() const;

  /// Returns the surfaces of a node's mesh: none if it has no mesh or is not visible.
  const Surfaces& surfaces(const Node& node) const;
  /// Returns the places of a node's instances, or nothing if the node stands for itself.
  std::optional<std::vector<Placement>> instances(const Node& node) const;
  std::vector<glm::dvec3> positions(const Json& surface) const;
  /// Returns whether the positions of a surface are floats, not whole numbers.
  bool hasRealPositions(const Json& surface) const;
  /// Returns all numbers of an attribute of a surface. Its elements have the type `type` ("VEC4") with
  /// `components` numbers. Fails unless there are `vertices` of them.
  std::vector<double> attribute(const Json& surface, const std::string& name, const char* type,
                                uint64_t components, std::optional<size_t> vertices = {}) const;
  /// Returns a surface's triangles, as indices of its own `vertexCount` vertices.
  std::vector<glm::uvec3> triangles(const Json& surface, size_t vertexCount) const;

  /// Throws if the scene is far too large for its file, or for the machine. Instances let a small file
  /// request any amount. Then decodes what Draco has compressed. To be called before surfaces are read.
  void open(size_t bytesPerVertex);
  /// Warns of primitives that do not consist of triangles, and of hidden meshes, if there are any.
  void warnOfOthers() const;

 private:
  void checkExtensions() const;
  void checkSize(size_t bytesPerVertex) const;
  std::vector<uint64_t> rootNodes() const;
  void findNodes();
  Surfaces readSurfaces(uint64_t mesh) const;
  /// Returns the accessors of a node's instances by the attributes' names; null if it has none.
  const Json* instanceAttributes(const Node& node) const;
  /// Returns the number of times that a node shows its mesh.
  uint64_t instanceCount(const Node& node) const;
  std::vector<uint32_t> corners(const Json& surface, size_t vertexCount) const;

  const MeshFile& file_;
  GltfDocument document_;
  std::vector<Node> nodes_;
  mutable std::map<uint64_t, Surfaces> surfaces_;  ///< By the mesh.
  std::map<const Json*, DracoSurface> draco_;      ///< By the primitive.
};

/// Reverses the triangles of a mirrored instance, which would otherwise face inwards.
void turnOver(std::span<glm::uvec3> triangles);

}  // namespace raymap
