#pragma once

#include "mesh_samples.h"

namespace raymap::samples {

/// Bytes of an image, as far as Raymap looks at them. Their number is odd.
inline const std::string kImage = "\x89PNG no pixels";

/// Returns the texture coordinates, from the bottom, of the textured GLB at a position of a face.
inline glm::vec2 uvAt(const glm::dvec3& p, const glm::dvec3& normal) {
  return {p.x / 8.0 + p.z / 16.0 + (std::abs(normal.x) > 0.9 ? 0.25 : 0.0), p.y / 8.0};
}

/// Returns the JSON of a glTF and sets its buffer: two crossing boxes of two materials, with seams between
/// faces. The first one has colours. Its accessors are positions, coordinates and indices of each, then
/// colours.
inline std::string texturedJson(std::string& buffer) {
  std::string views, accessors;
  size_t count = 0;
  const auto add = [&](const std::string& bytes, const std::string& accessor) {
    const std::string comma = count == 0 ? "" : ",";
    views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(buffer.size()) + R"(,"byteLength":)" +
             std::to_string(bytes.size()) + "}";
    if (!accessor.empty())
      accessors +=
          comma + R"({"bufferView":)" + std::to_string(count) + R"(,"componentType":)" + accessor + "}";
    ++count;
    buffer += bytes + std::string((8 - bytes.size() % 8) % 8, '\0');
  };
  for (const int box : {0, 1}) {
    std::string positions, uvs, indices;
    for (uint16_t face = 0; face < 6; ++face) {
      glm::dvec3 normal(0.0);
      normal[face / 2] = face % 2 == 0 ? -1.0 : 1.0;
      for (int corner = 0; corner < 4; ++corner) {
        glm::dvec3 p(box + face % 2 * 2);
        p[(face / 2 + 1 + face % 2) % 3] = box + (corner == 1 || corner == 2 ? 0 : 2);
        p[(face / 2 + 2 - face % 2) % 3] = box + (corner / 2) * 2;
        positions += raw<float>({float(p.x), float(p.y), float(p.z)});
        uvs += raw<float>({uvAt(p, normal).x, 1.0F - uvAt(p, normal).y});
      }
      for (const int corner : {0, 1, 2, 0, 2, 3}) indices += raw(uint16_t(4 * face + corner));
    }
    add(positions, R"(5126,"count":24,"type":"VEC3")");
    add(uvs, R"(5126,"count":24,"type":"VEC2")");
    add(indices, R"(5123,"count":36,"type":"SCALAR")");
  }
  std::string colours;
  for (int v = 0; v < 24; ++v) colours += raw<uint8_t>({51, 102, 0, 255});
  add(colours, R"(5121,"normalized":true,"count":24,"type":"VEC4")");
  add(kImage, "");
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[)"
         R"({"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":6},"indices":2,"material":0},)"
         R"({"attributes":{"POSITION":3,"TEXCOORD_0":4},"indices":5,"material":1}]}],)"
         R"("extensionsUsed":["KHR_texture_transform","KHR_lights_punctual"],)"
         R"("extensionsRequired":["KHR_texture_transform"],"materials":[{"name":"paint",)"
         R"("pbrMetallicRoughness":{"baseColorTexture":{"extensions":{"KHR_texture_transform":{"scale":[2,3]}},)"
         R"("index":0}},"normalTexture":{"index":0,"texCoord":1}},{"alphaCutoff":0.5,"alphaMode":"MASK"}],)"
         R"("textures":[{"sampler":0,"source":0}],"samplers":[{"wrapS":33071}],"images":[{"bufferView":7,)"
         R"("mimeType":"image/png"}],"accessors":[)" +
         accessors + R"(],"bufferViews":[)" + views + R"(],"buffers":[{"byteLength":)" +
         std::to_string(buffer.size()) + "}]}";
}

}  // namespace raymap::samples
