// Reads a mesh with Assimp, for `raymap-import`.

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <raymap/error.h>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <glm/glm.hpp>
#include <map>
#include <new>
#include <string>
#include <string_view>
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
  MeshHeader header;
  std::vector<MeshRun> runs;
  std::string partNames, materialNames;
  std::vector<glm::vec4> materialColours, colours;
  std::vector<glm::vec2> uvs;
  std::map<unsigned, uint32_t> materials;  ///< Numbers of those of the scene.
};

glm::dmat4 matrix(const aiMatrix4x4& m) {
  return glm::transpose(glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
                                   m.d1, m.d2, m.d3, m.d4));
}

/// Appends the triangles of a face, whose vertices follow `first`.
void appendFace(const aiMesh& mesh, const aiFace& face, uint32_t first, bool isMirrored, Result& result) {
  if (face.mNumIndices < 3) ++result.header.otherFaces;
  std::vector<glm::dvec3> corners;
  for (unsigned c = 0; c < face.mNumIndices; ++c) {
    if (face.mIndices[c] >= mesh.mNumVertices)
      throw Error(ErrorCode::Input, "a face uses vertex " + std::to_string(face.mIndices[c]) +
                                        " of a mesh that has " + std::to_string(mesh.mNumVertices));
    const aiVector3D& p = mesh.mVertices[face.mIndices[c]];
    corners.emplace_back(p.x, p.y, p.z);
  }
  std::vector<glm::uvec3> triangles;
  if (cutPolygon(corners, triangles) == PolygonCut::None) ++result.header.uncutFaces;
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

/// Returns whether a node has a name that is not Assimp's.
bool isNamed(const aiNode& node) {
  return node.mName.length > 0 && !std::string_view(node.mName.C_Str()).starts_with("$ColladaAutoName$");
}

void appendName(const aiString& name, std::string& names) {
  names.append(name.C_Str());  // Up to a 0.
  names.push_back('\0');
}

/// Returns the number of a material. Assimp invents one where there is none.
uint32_t numberOf(const aiScene& scene, unsigned index, Result& result) {
  if (index >= scene.mNumMaterials) return MeshRun::kNone;
  const aiMaterial& material = *scene.mMaterials[index];
  if (material.GetName() == aiString(AI_DEFAULT_MATERIAL_NAME)) return MeshRun::kNone;
  const auto [place, isNew] = result.materials.try_emplace(index, uint32_t(result.materialColours.size()));
  if (!isNew) return place->second;
  aiColor4D colour(1.0F);
  float opacity = 1.0F;
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS)
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  material.Get(AI_MATKEY_OPACITY, opacity);
  appendName(material.GetName(), result.materialNames);
  result.materialColours.emplace_back(colour.r, colour.g, colour.b, opacity);
  for (unsigned type = 1; type <= AI_TEXTURE_TYPE_MAX; ++type)
    result.header.textures += material.GetTextureCount(aiTextureType(type));
  return place->second;
}

/// Appends the attributes of a mesh, of which the vertices and triangles are the last ones.
void appendAttributes(const aiScene& scene, const aiMesh& mesh, MeshRun run, Result& result) {
  run.material = numberOf(scene, mesh.mMaterialIndex, result);
  run.hasUvs = mesh.HasTextureCoords(0) ? 1 : 0;
  run.hasColours = mesh.HasVertexColors(0) ? 1 : 0;
  result.runs.push_back(run);
  MeshHeader& header = result.header;
  header.moreUvs |= mesh.HasTextureCoords(1) ? 1 : 0;
  header.moreColours |= mesh.HasVertexColors(1) ? 1 : 0;
  header.hasUvs |= run.hasUvs;
  header.hasColours |= run.hasColours;
  if (run.hasUvs != 0) result.uvs.resize(result.positions.size() - mesh.mNumVertices);
  if (run.hasColours != 0) result.colours.resize(result.positions.size() - mesh.mNumVertices);
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    if (const aiVector3D* uvs = mesh.mTextureCoords[0]) result.uvs.emplace_back(uvs[v].x, uvs[v].y);
    if (const aiColor4D* c = mesh.mColors[0]) result.colours.emplace_back(c[v].r, c[v].g, c[v].b, c[v].a);
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
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node->mMeshes[m]];
      const size_t before = result.triangles.size();
      appendMesh(mesh, transform, result);
      appendAttributes(scene, mesh,
                       {.triangles = result.triangles.size() - before,
                        .part = isNamed(*node) ? uint32_t(result.header.parts) : MeshRun::kNone},
                       result);
    }
    if (node->mNumMeshes > 0 && isNamed(*node)) {
      ++result.header.parts;
      appendName(node->mName, result.partNames);
    }
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
  importer.SetIOHandler(new NoFiles);                                          // The importer deletes it.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);  // Not identifiers.
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str() + 1);
}

void send(Result& result) {
  MeshHeader& header = result.header;
  header.vertices = result.positions.size();
  header.triangles = result.triangles.size();
  header.runs = result.runs.size();
  header.materials = result.materialColours.size();
  header.nameBytes = result.partNames.size() + result.materialNames.size();
  if (header.hasUvs != 0) result.uvs.resize(header.vertices);
  if (header.hasColours != 0) result.colours.resize(header.vertices);
  const auto putAll = [](const auto& values) { put(values.data(), values.size() * sizeof(values[0])); };
  put(&header, sizeof header);
  putAll(result.positions);
  putAll(result.triangles);
  putAll(result.runs);
  putAll(result.partNames);
  putAll(result.materialNames);
  putAll(result.materialColours);
  putAll(result.uvs);
  putAll(result.colours);
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
  send(result);
}

}  // namespace raymap
