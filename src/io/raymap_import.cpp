// raymap-import FILE MEMORY SECONDS: reads a mesh with Assimp and writes it as import_stream.h says.
//
// A process of its own, because Assimp crashes on some damaged files and takes any amount of memory on
// others.

#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <cstdlib>
#include <exception>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "import_stream.h"

namespace {

struct Result {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
  uint64_t otherFaces = 0;
};

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

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

void appendNodes(const aiScene& scene, Result& result) {
  std::vector<std::pair<const aiNode*, glm::dmat4>> stack{{scene.mRootNode, glm::dmat4(1.0)}};
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const glm::dmat4 transform = parent * matrix(node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; ++m)
      appendMesh(*scene.mMeshes[node->mMeshes[m]], transform, result);
    for (unsigned c = node->mNumChildren; c > 0; --c) stack.emplace_back(node->mChildren[c - 1], transform);
  }
}

void put(const void* data, size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = write(STDOUT_FILENO, at, bytes);
    if (written <= 0) std::_Exit(EXIT_FAILURE);  // Nobody is left to tell.
    at += written;
    bytes -= static_cast<size_t>(written);
  }
}

void send(bool failed, const std::string& message, const Result& result) {
  raymap::ImportHeader header;
  header.failed = failed ? 1 : 0;
  header.messageBytes = message.size();
  header.vertices = result.positions.size();
  header.triangles = result.triangles.size();
  put(&header, sizeof header);
  put(message.data(), message.size());
  put(result.positions.data(), result.positions.size() * sizeof(glm::dvec3));
  put(result.triangles.data(), result.triangles.size() * sizeof(glm::uvec3));
}

void importFile(const char* path) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, 0);
  if (!scene || !scene->mRootNode) return send(true, importer.GetErrorString(), {});
  Result result;
  appendNodes(*scene, result);
  const std::string others = std::to_string(result.otherFaces) + " points, lines or empty faces ignored";
  send(false, result.otherFaces > 0 ? others : "", result);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return EXIT_FAILURE;
  limit(RLIMIT_AS, std::strtoull(argv[2], nullptr, 10));
  limit(RLIMIT_CPU, std::strtoull(argv[3], nullptr, 10));
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  try {
    importFile(argv[1]);
  } catch (const std::bad_alloc&) {
    send(true, "it needs more memory than a file of its size may take", {});
  } catch (const std::exception& error) {
    send(true, error.what(), {});
  }
  std::_Exit(EXIT_SUCCESS);  // Without taking down what a damaged file may have left inconsistent.
}
