#pragma once

#include <span>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace raymap {

/// The default scene of a glTF file: its nodes, and what its meshes are made of.
class GltfScene {
 public:
  using Json = GltfDocument::Json;

  struct Node {
    uint64_t index = 0;  ///< Among the file's nodes.
    int parent = -1;     ///< Among the scene's, before this one; -1 = none.
    const Json* json = nullptr;
  };

  /// Fails if the file requires what we cannot read, or its nodes form no trees.
  explicit GltfScene(const MeshFile& file);

  const GltfDocument& document() const { return document_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Of a node, after its parent's.
  glm::dmat4 transform(const Json& node) const;
  /// Of every node, to the scene.
  std::vector<glm::dmat4> worldTransforms() const;

  /// The primitives of a node's mesh that are made of triangles.
  std::vector<const Json*> surfaces(const Json& node) const;
  std::vector<glm::dvec3> positions(const Json& surface) const;
  /// A surface's triangles among its own `vertexCount` vertices.
  std::vector<glm::uvec3> triangles(const Json& surface, size_t vertexCount) const;

  /// Instances let a small file ask for any amount of memory: refuses more than the machine has.
  void checkSize(size_t bytesPerVertex) const;
  /// Says how many primitives are not made of triangles.
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

/// Turns triangles of a mirrored instance, whose outside would be inside.
void turnOver(std::span<glm::uvec3> triangles);

}  // namespace raymap
