#include <raymap/error.h>

#include <array>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "io/mesh/mesh_formats.h"

namespace raymap {

namespace {

using Json = nlohmann::ordered_json;

// Constants of glTF 2.0.
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kFloat = 5126, kUnsignedInt = 5125;

Json vector(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// Returns the JSON chunk. Vertices are stored relative to the mesh's origin. The node's translation holds
/// the origin in double precision.
Json describe(const PackedMesh& mesh, const glm::dvec3& offset, size_t vertexBytes, size_t triangleBytes) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
  Json asset = {{"version", "2.0"}, {"generator", "raymap"}};
  if (offset != glm::dvec3(0.0)) asset["extras"] = {{"offset", vector(offset)}};
  return {{"asset", std::move(asset)},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}, {"translation", vector(mesh.origin)}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
          {"accessors",
           {{{"bufferView", 0},
             {"componentType", kFloat},
             {"count", mesh.vertices.size()},
             {"type", "VEC3"},
             {"min", vector(low)},
             {"max", vector(high)}},
            {{"bufferView", 1},
             {"componentType", kUnsignedInt},
             {"count", 3 * mesh.triangles.size()},
             {"type", "SCALAR"}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteLength", vertexBytes}, {"target", kArrayBuffer}},
            {{"buffer", 0},
             {"byteOffset", vertexBytes},
             {"byteLength", triangleBytes},
             {"target", kElementArrayBuffer}}}},
          {"buffers", {{{"byteLength", vertexBytes + triangleBytes}}}}};
}

void writeNumbers(std::ostream& out, const std::array<uint32_t, 2>& numbers) {
  char bytes[sizeof(numbers)];
  append(bytes, numbers);
  out.write(bytes, sizeof(bytes));
}

}  // namespace

void writeGlb(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  constexpr uint32_t kMagic = 0x46546c67, kVersion = 2, kJson = 0x4e4f534a, kBinary = 0x004e4942;
  constexpr size_t kHeader = 12, kChunkHeader = 8;
  const size_t vertexBytes = mesh.vertices.size() * sizeof(glm::vec3);
  const size_t triangleBytes = mesh.triangles.size() * sizeof(glm::uvec3);
  std::string json = describe(mesh, offset, vertexBytes, triangleBytes).dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t binary = vertexBytes + triangleBytes;
  const size_t total = kHeader + kChunkHeader + json.size() + kChunkHeader + binary;
  if (total > UINT32_MAX) throw Error(ErrorCode::Unsupported, "a GLB holds 4 GiB at most; write a .ply");
  const auto bytes = [](size_t count) { return static_cast<uint32_t>(count); };
  writeNumbers(out, {kMagic, kVersion});
  char length[sizeof(uint32_t)];
  append(length, bytes(total));
  out.write(length, sizeof(length));
  writeNumbers(out, {bytes(json.size()), kJson});
  out << json;
  writeNumbers(out, {bytes(binary), kBinary});
  out.write(reinterpret_cast<const char*>(mesh.vertices.data()), std::streamsize(vertexBytes));
  out.write(reinterpret_cast<const char*>(mesh.triangles.data()), std::streamsize(triangleBytes));
}

}  // namespace raymap
