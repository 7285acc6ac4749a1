#include <raymap/error.h>

#include <array>
#include <bit>
#include <compare>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "base/parallel_sort.h"
#include "io/mesh/base_colour.h"
#include "io/mesh/gltf_materials.h"
#include "io/mesh/mesh_formats.h"
#include "io/mesh/named_objects.h"

namespace raymap {

namespace {

using Json = nlohmann::json;

// Constants of glTF 2.0.
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kFloat = 5126, kUnsignedInt = 5125;

Json vector(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// Triangles of one material, and their vertices.
struct GlbPrimitive {
  uint32_t material = kNoAttribute;
  std::span<const glm::vec3> vertices = {};
  std::span<const glm::uvec3> triangles = {};
  Mesh own = {};  ///< Those of a primitive that is a part of its object.
  std::vector<glm::vec2> uvs = {};
  std::vector<glm::vec4> colours = {};
};

/// Material, vertex, bits of texture coordinates and colour, and number of a corner. Corners that differ in
/// their number alone are one vertex of the file.
using Corner = std::array<uint32_t, 9>;

/// Splits an object by material, and its vertices where corners have different values.
std::vector<GlbPrimitive> split(const NamedObject& object, const MeshAttributes& attributes) {
  if (attributes.materialOf.empty() && attributes.uvs.corners.empty() && attributes.colours.corners.empty())
    return {{.vertices = object.mesh().vertices, .triangles = object.mesh().triangles}};
  std::vector<glm::uvec3> triangles(object.mesh().triangles.size());
  std::vector<Corner> corners;
  for (size_t i = 0; i < 3 * triangles.size(); ++i) {
    const size_t face = object.faces.empty() ? i / 3 : object.faces[i / 3];
    const auto valueOf = [&](const auto& given, auto none) {
      const uint32_t id = given.corners.empty() ? kNoAttribute : given.corners[face][int(i % 3)];
      return id == kNoAttribute ? none : given.values[id];
    };
    glm::vec2 uv = valueOf(attributes.uvs, glm::vec2(0.0F));
    uv.y = 1.0F - uv.y;  // A glTF counts from the top.
    const glm::vec4 colour = valueOf(attributes.colours, glm::vec4(1.0F));
    const auto bits = [](float value) { return std::bit_cast<uint32_t>(value); };
    corners.push_back({attributes.materialOf.empty() ? kNoAttribute : attributes.materialOf[face],
                       object.mesh().triangles[i / 3][int(i % 3)], bits(uv.x), bits(uv.y), bits(colour.x),
                       bits(colour.y), bits(colour.z), bits(colour.w), uint32_t(i)});
  }
  parallelSort(corners.begin(), corners.end());
  std::vector<GlbPrimitive> primitives;
  std::vector<size_t> owners(triangles.size());
  for (const Corner* last = nullptr; const Corner& c : corners) {
    if (primitives.empty() || c[0] != primitives.back().material) primitives.push_back({c[0]});
    GlbPrimitive& primitive = primitives.back();
    if (primitive.own.vertices.empty() || !std::equal(c.begin(), c.end() - 1, last->begin())) {
      const auto values = std::bit_cast<std::array<float, std::tuple_size_v<Corner>>>(c);
      primitive.own.vertices.push_back(object.mesh().vertices[c[1]]);
      if (!attributes.uvs.corners.empty()) primitive.uvs.emplace_back(values[2], values[3]);
      if (!attributes.colours.corners.empty())
        primitive.colours.push_back(linearColour({values[4], values[5], values[6], values[7]}));
    }
    last = &c;
    triangles[c[8] / 3][int(c[8] % 3)] = uint32_t(primitive.own.vertices.size() - 1);
    owners[c[8] / 3] = primitives.size() - 1;
  }
  for (size_t f = 0; f < triangles.size(); ++f) primitives[owners[f]].own.triangles.push_back(triangles[f]);
  for (GlbPrimitive& each : primitives)
    each.vertices = each.own.vertices, each.triangles = each.own.triangles;
  return primitives;
}

/// The JSON chunk and the binary chunk of a GLB. Vertices are stored relative to the mesh's origin. The
/// translation of each node holds the origin in double precision.
struct GlbChunks {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "raymap"}}}, {"scene", 0}};
  std::vector<std::span<const std::byte>> pieces = {};
  size_t bytes = 0;

  size_t addView(std::span<const std::byte> piece, const Json& more = Json::object()) {
    Json& view = json["bufferViews"].emplace_back(more);
    view.update({{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", piece.size()}});
    pieces.push_back(piece);
    bytes += (piece.size() + 3) / 4 * 4;
    return pieces.size() - 1;
  }

  template <class T>
  size_t addAccessor(std::span<const T> values, const char* type) {
    constexpr bool kIsIndex = std::is_same_v<T, glm::uvec3>;
    const size_t view =
        addView(std::as_bytes(values), {{"target", kIsIndex ? kElementArrayBuffer : kArrayBuffer}});
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", kIsIndex ? kUnsignedInt : kFloat},
                                 {"count", values.size() * (kIsIndex ? 3 : 1)},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }

  Json add(const GlbPrimitive& primitive) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& v : primitive.vertices) low = glm::min(low, v), high = glm::max(high, v);
    Json result = {{"attributes", {{"POSITION", addAccessor(primitive.vertices, "VEC3")}}}};
    json["accessors"].back().update({{"min", vector(low)}, {"max", vector(high)}});
    result["indices"] = addAccessor(primitive.triangles, "SCALAR");
    const auto addValues = [&](const char* name, const auto& values, const char* type) {
      if (!values.empty()) result["attributes"][name] = addAccessor(std::span(values), type);
    };
    addValues("TEXCOORD_0", primitive.uvs, "VEC2");
    addValues("COLOR_0", primitive.colours, "VEC4");
    if (primitive.material != kNoAttribute) result["material"] = primitive.material;
    return result;
  }

  void add(const NamedObject& object, const std::vector<GlbPrimitive>& primitives) {
    const size_t number = json["nodes"].size();
    Json& node =
        json["nodes"].emplace_back(Json{{"mesh", number}, {"translation", vector(object.mesh().origin)}});
    Json& shape = json["meshes"].emplace_back();
    if (!object.name.empty()) node["name"] = shape["name"] = object.name;
    for (const GlbPrimitive& primitive : primitives) shape["primitives"].push_back(add(primitive));
    json["scenes"][0]["nodes"].push_back(number);
  }

  /// Adds materials with what a glTF said of them, or else their names.
  void addMaterials(const MeshAttributes& attributes) {
    if (attributes.gltf) {
      json.update(attributes.gltf->root);
      for (Json& image : json["images"])
        if (const auto at = image.find("bufferView"); at != image.end())
          *at = addView(attributes.gltf->images[at->get<size_t>()]);
      if (json["images"].empty()) json.erase("images");
    }
    for (size_t m = json["materials"].size(); m < attributes.materials.size(); ++m)
      json["materials"].push_back({{"name", attributes.materials[m]}});
  }
};

void writeNumbers(std::ostream& out, const std::array<uint32_t, 2>& numbers) {
  char bytes[sizeof(numbers)];
  append(bytes, numbers);
  out.write(bytes, sizeof(bytes));
}

}  // namespace

void writeGlb(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  constexpr uint32_t kMagic = 0x46546c67, kVersion = 2, kJson = 0x4e4f534a, kBinary = 0x004e4942;
  constexpr size_t kHeader = 12, kChunkHeader = 8;
  static const MeshAttributes kNoAttributes;
  const MeshAttributes& attributes = mesh.attributes ? *mesh.attributes : kNoAttributes;
  const std::vector<NamedObject> objects = namedObjects(mesh);
  std::vector<std::vector<GlbPrimitive>> primitives;
  GlbChunks chunks;
  if (offset != glm::dvec3(0.0)) chunks.json["asset"]["extras"] = {{"offset", vector(offset)}};
  for (const NamedObject& object : objects)
    chunks.add(object, primitives.emplace_back(split(object, attributes)));
  if (!attributes.materials.empty()) chunks.addMaterials(attributes);
  chunks.json["buffers"][0]["byteLength"] = chunks.bytes;
  // Names may be no UTF-8.
  std::string json = chunks.json.dump(-1, ' ', false, Json::error_handler_t::replace);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t total = kHeader + kChunkHeader + json.size() + kChunkHeader + chunks.bytes;
  if (total > UINT32_MAX) throw Error(ErrorCode::Unsupported, "a GLB holds 4 GiB at most; write a .ply");
  const auto bytes = [](size_t count) { return static_cast<uint32_t>(count); };
  writeNumbers(out, {kMagic, kVersion});
  char length[sizeof(uint32_t)];
  append(length, bytes(total));
  out.write(length, sizeof(length));
  writeNumbers(out, {bytes(json.size()), kJson});
  out << json;
  writeNumbers(out, {bytes(chunks.bytes), kBinary});
  for (const std::span<const std::byte> piece : chunks.pieces) {
    out.write(reinterpret_cast<const char*>(piece.data()), std::streamsize(piece.size()));
    out.write("\0\0\0", std::streamsize(-piece.size() % 4));
  }
}

}  // namespace raymap
