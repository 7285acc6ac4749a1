// Reads a mesh with Assimp, for `raymap-import`.

#include <assimp/material.h>
#include <assimp/scene.h>
#include <raymap/error.h>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <glm/glm.hpp>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "base/text.h"
#include "io/import/import_stream.h"
#include "io/import/raymap_import.h"
#include "mesh/polygon.h"

namespace raymap {

namespace {

struct Result {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
  uint64_t otherFaces = 0, uncutFaces = 0, partNames = 0, hasUvs = 0, hasColours = 0;
  std::set<unsigned> materials;
};

glm::dmat4 matrix(const aiMatrix4x4& m) {
  return glm::transpose(glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
                                   m.d1, m.d2, m.d3, m.d4));
}

/// Appends the triangles of a face, whose vertices follow `first`.
void appendFace(const aiMesh& mesh, const aiFace& face, uint32_t first, bool isMirrored, Result& result) {
  if (face.mNumIndices < 3) ++result.otherFaces;
  std::vector<glm::dvec3> corners;
  for (unsigned c = 0; c < face.mNumIndices; ++c) {
    if (face.mIndices[c] >= mesh.mNumVertices)
      throw Error(ErrorCode::Input, "a face uses vertex " + std::to_string(face.mIndices[c]) +
                                        " of a mesh that has " + std::to_string(mesh.mNumVertices));
    const aiVector3D& p = mesh.mVertices[face.mIndices[c]];
    corners.emplace_back(p.x, p.y, p.z);
  }
  std::vector<glm::uvec3> triangles;
  if (cutPolygon(corners, triangles) == PolygonCut::None) ++result.uncutFaces;
  for (const glm::uvec3& t : triangles) {
    glm::uvec3 triangle(face.mIndices[t.x], face.mIndices[t.y], face.mIndices[t.z]);
    if (isMirrored) std::swap(triangle.y, triangle.z);
    result.triangles.push_back(triangle + first);
  }
}

void appendMesh(const aiMesh& mesh, const glm::dmat4& transform, Result& result) {
  const auto first = static_cast<uint32_t>(result.positions.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& p = mesh.mVertices[v];
    result.positions.emplace_back(transform * glm::dvec4(p.x, p.y, p.z, 1.0));
  }
  const bool isMirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) appendFace(mesh, mesh.mFaces[f], first, isMirrored, result);
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
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node->mMeshes[m]];
      appendMesh(mesh, transform, result);
      // Assimp invents a material where there is none.
      if (mesh.mMaterialIndex < scene.mNumMaterials &&
          scene.mMaterials[mesh.mMaterialIndex]->GetName() != aiString(AI_DEFAULT_MATERIAL_NAME))
        result.materials.insert(mesh.mMaterialIndex);
      result.hasUvs |= uint64_t{mesh.HasTextureCoords(0)};
      result.hasColours |= uint64_t{mesh.HasVertexColors(0)};
    }
    result.partNames += node->mNumMeshes > 0 && node->mName.length > 0 ? 1 : 0;
    for (unsigned c = node->mNumChildren; c > 0; --c) stack.emplace_back(node->mChildren[c - 1], transform);
  }
}

/// Opens no file: a mesh of which Assimp would read other files is read without them.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

const aiScene* readScene(Assimp::Importer& importer, const std::string& bytes, const std::string& format) {
  importer.SetIOHandler(new NoFiles);  // The importer deletes it.
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str() + 1);
}

}  // namespace

void sendMesh(int file, const std::string& format) {
  Assimp::Importer importer;
  const std::string bytes = bytesOf(file);
  const aiScene* scene = readScene(importer, bytes, format);
  if (!scene || !scene->mRootNode) {
    const std::string reason = importer.GetErrorString();
    // Texts of exceptions about sizes. The caller words them.
    for (const char* text : {"bad_alloc", "bad_array_new_length", "vector::", "basic_string::"})
      if (reason.find(text) != reason.npos) throw std::bad_alloc();
    throw Error(ErrorCode::Input, withExcerpts(reason));
  }
  Result result;
  appendNodes(*scene, result);
  sendSuccess("");
  const MeshHeader header{result.positions.size(), result.triangles.size(), result.otherFaces,
                          result.uncutFaces,       result.partNames,        result.materials.size(),
                          result.hasUvs,           result.hasColours};
  put(&header, sizeof header);
  put(result.positions.data(), result.positions.size() * sizeof(glm::dvec3));
  put(result.triangles.data(), result.triangles.size() * sizeof(glm::uvec3));
}

}  // namespace raymap
