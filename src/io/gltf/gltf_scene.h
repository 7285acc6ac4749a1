#pragma once

#include <span>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace raymap {

/// The default scene of a glTF file: its nodes and the surfaces of its meshes.
class GltfScene {
 public:
  using Json = GltfDocument::Json;

  struct Node {
    uint64_t index = 0;  ///< Index among the file's nodes.
    int parent = -1;     ///< Index of an earlier node of the scene; -1 for none.
    const Json* json = nullptr;
  };

  /// Fails if the file requires an unsupported extension or its nodes do not form trees.
  explicit GltfScene(const MeshFile& file);

  const GltfDocument& document() const { return document_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Returns `count` numbers of a node, or none if the key is missing.
  std::vector<double> numbers(const Node& node, const char* key, size_t count) const;
  /// Returns a node's transform, relative to its parent.
  glm::dmat4 transform(const Node& node) const;
  /// Returns the transform of every node to the scene.
  std::vector<glm::dmat4> worldTransforms() const;

  /// Returns the primitives of a node's mesh that consist of triangles and have positions.
  std::vector<const Json*> surfaces(const Json& node) const;
  std::vector<glm::dvec3> positions(const Json& surface) const;
  /// Returns a surface's triangles, as indices of its own `vertexCount` vertices.
  std::vector<glm::uvec3> triangles(const Json& surface, size_t vertexCount) const;

  /// Throws `Error(Memory)` if the scene takes more than half of the machine's memory. Instances let a small
  /// file request any amount.
  void checkSize(size_t bytesPerVertex) const;
  /// Warns of primitives that do not consist of triangles, if there are any.
  void warnOfOthers() const;

 private:
  void checkExtensions() const;
  std::vector<uint64_t> rootNodes() const;
  void findNodes();
  std::vector<const Json*> primitives(const Json& node) const;
  bool hasTriangles(const Json& primitive) const;
  std::vector<uint32_t> corners(const Json& surface, size_t vertexCount) const;

  const MeshFile& file_;
  GltfDocument document_;
  std::vector<Node> nodes_;
};

/// Reverses the triangles of a mirrored instance, which would otherwise face inwards.
void turnOver(std::span<glm::uvec3> triangles);

}  // namespace raymap
