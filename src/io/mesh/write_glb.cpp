#include <raymap/error.h>

#include <array>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "io/mesh/mesh_formats.h"
#include "io/mesh/named_objects.h"

namespace raymap {

namespace {

using Json = nlohmann::ordered_json;

// Constants of glTF 2.0.
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kFloat = 5126, kUnsignedInt = 5125;

Json vector(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// Returns the accessor of the vertices of an object, which lie behind those of others.
Json vertexAccessor(const PackedMesh& mesh, size_t verticesBefore) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
  Json accessor = {{"bufferView", 0}};
  if (verticesBefore > 0) accessor["byteOffset"] = verticesBefore * sizeof(glm::vec3);
  accessor.update({{"componentType", kFloat},
                   {"count", mesh.vertices.size()},
                   {"type", "VEC3"},
                   {"min", vector(low)},
                   {"max", vector(high)}});
  return accessor;
}

Json triangleAccessor(const PackedMesh& mesh, size_t trianglesBefore) {
  Json accessor = {{"bufferView", 1}};
  if (trianglesBefore > 0) accessor["byteOffset"] = trianglesBefore * sizeof(glm::uvec3);
  accessor.update(
      {{"componentType", kUnsignedInt}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}});
  return accessor;
}

/// Returns the JSON chunk. Vertices are stored relative to the mesh's origin. The translation of each node
/// holds the origin in double precision.
Json describe(const std::vector<NamedObject>& objects, const glm::dvec3& offset, size_t vertexBytes,
              size_t triangleBytes) {
  Json asset = {{"version", "2.0"}, {"generator", "raymap"}};
  if (offset != glm::dvec3(0.0)) asset["extras"] = {{"offset", vector(offset)}};
  Json numbers, nodes, meshes, accessors;
  size_t vertices = 0, triangles = 0;
  for (size_t k = 0; k < objects.size(); ++k) {
    const WritableMesh& mesh = objects[k].mesh();
    Json node = {{"mesh", k}, {"translation", vector(mesh.origin)}},
         shape = {{"primitives", {{{"attributes", {{"POSITION", 2 * k}}}, {"indices", 2 * k + 1}}}}};
    if (!objects[k].name.empty()) node["name"] = shape["name"] = objects[k].name;
    numbers.push_back(k);
    nodes.push_back(std::move(node));
    meshes.push_back(std::move(shape));
    accessors.push_back(vertexAccessor(mesh, vertices));
    accessors.push_back(triangleAccessor(mesh, triangles));
    vertices += mesh.vertices.size(), triangles += mesh.triangles.size();
  }
  return {{"asset", std::move(asset)},
          {"scene", 0},
          {"scenes", {{{"nodes", std::move(numbers)}}}},
          {"nodes", std::move(nodes)},
          {"meshes", std::move(meshes)},
          {"accessors", std::move(accessors)},
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
  const std::vector<NamedObject> objects = namedObjects(mesh);
  size_t vertexBytes = 0;
  for (const NamedObject& object : objects) vertexBytes += object.mesh().vertices.size_bytes();
  const size_t triangleBytes = mesh.triangles.size_bytes();
  // Names may be no UTF-8.
  std::string json = describe(objects, offset, vertexBytes, triangleBytes)
                         .dump(-1, ' ', false, Json::error_handler_t::replace);
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
  const auto write = [&](const auto& elements) {
    out.write(reinterpret_cast<const char*>(elements.data()), std::streamsize(elements.size_bytes()));
  };
  for (const NamedObject& object : objects) write(object.mesh().vertices);
  for (const NamedObject& object : objects) write(object.mesh().triangles);
}

}  // namespace raymap
