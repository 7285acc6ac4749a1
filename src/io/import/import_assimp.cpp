// Reads a mesh with Assimp, for `raymap-import`.

#include <assimp/scene.h>
#include <raymap/error.h>

#include <assimp/Importer.hpp>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <iterator>
#include <string>
#include <vector>

#include "io/import/import_stream.h"
#include "io/import/raymap_import.h"

namespace raymap {

namespace {

struct Result {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
  uint64_t otherFaces = 0;
};

glm::dmat4 matrix(const aiMatrix4x4& m) {
  return glm::transpose(glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
                                   m.d1, m.d2, m.d3, m.d4));
}

void appendMesh(const aiMesh& mesh, const glm::dmat4& transform, Result& result) {
  const auto first = static_cast<uint32_t>(result.positions.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& p = mesh.mVertices[v];
    result.positions.emplace_back(transform * glm::dvec4(p.x, p.y, p.z, 1.0));
  }
  const bool isMirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) ++result.otherFaces;
    for (unsigned i = 2; i < face.mNumIndices; ++i) {
      glm::uvec3 triangle(face.mIndices[0], face.mIndices[i - 1], face.mIndices[i]);
      if (isMirrored) std::swap(triangle.y, triangle.z);
      result.triangles.push_back(triangle + first);
    }
  }
}

/// Returns a node's transform as the file stores it. The root of an FBX has none, but Assimp 5.4 and later
/// rotate and scale it to axes and units of their own. Only FBX has the metadata UpAxis.
glm::dmat4 ownTransform(const aiNode& node, const aiScene& scene) {
  const bool isFbx = scene.mMetaData && scene.mMetaData->HasKey("UpAxis");
  return isFbx && &node == scene.mRootNode ? glm::dmat4(1.0) : matrix(node.mTransformation);
}

void appendNodes(const aiScene& scene, Result& result) {
  std::vector<std::pair<const aiNode*, glm::dmat4>> stack{{scene.mRootNode, glm::dmat4(1.0)}};
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const glm::dmat4 transform = parent * ownTransform(*node, scene);
    for (unsigned m = 0; m < node->mNumMeshes; ++m)
      appendMesh(*scene.mMeshes[node->mMeshes[m]], transform, result);
    for (unsigned c = node->mNumChildren; c > 0; --c) stack.emplace_back(node->mChildren[c - 1], transform);
  }
}

/// Reads the file, or its bytes if its name has another extension than the format: Assimp goes by that.
const aiScene* readScene(Assimp::Importer& importer, const std::filesystem::path& path,
                         const std::string& format) {
  if (path.extension() == format) return importer.ReadFile(path, 0);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str() + 1);
}

}  // namespace

void sendMesh(const char* path, const std::string& format) {
  Assimp::Importer importer;
  const aiScene* scene = readScene(importer, path, format);
  if (!scene || !scene->mRootNode) throw Error(ErrorCode::Input, importer.GetErrorString());
  Result result;
  appendNodes(*scene, result);
  sendSuccess(result.otherFaces > 0
                  ? std::to_string(result.otherFaces) + " points, lines or empty faces ignored"
                  : "");
  const MeshHeader header{result.positions.size(), result.triangles.size()};
  put(&header, sizeof header);
  put(result.positions.data(), result.positions.size() * sizeof(glm::dvec3));
  put(result.triangles.data(), result.triangles.size() * sizeof(glm::uvec3));
}

}  // namespace raymap
