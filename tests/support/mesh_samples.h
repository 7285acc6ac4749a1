#pragma once

// Small mesh files made on the spot: a unit square in z = 0 as two triangles, unless said otherwise.

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/mesh_view.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "contains.h"
#include "files.h"
#include "io/mesh/mesh_file.h"

namespace raymap::samples {

using raymap::contains;

/// Returns the bytes of a value, in reverse order if `swap`.
template <class T>
std::string raw(T value, bool swap = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return swap ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

template <class T>
std::string raw(std::initializer_list<T> values, bool swap = false) {
  std::string bytes;
  for (const T value : values) bytes += raw(value, swap);
  return bytes;
}

inline const std::string kTextStl =
    "solid square\n"
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n endloop\nendfacet\n"
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 1 0\n  vertex 0 1 0\n endloop\nendfacet\n"
    "endsolid square\n";

inline std::string binaryStl(uint32_t announced = 2) {
  std::string bytes(80, ' ');
  bytes += raw(announced);
  bytes += raw<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0}) + raw<uint16_t>(0);
  bytes += raw<float>({0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0}) + raw<uint16_t>(0);
  return bytes;
}

inline const std::string kPlyElements =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
inline const std::string kTextPly =
    "ply\nformat ascii 1.0\n" + kPlyElements + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

inline std::string binaryPly(bool bigEndian = false) {
  return std::string("ply\nformat binary_") + (bigEndian ? "big" : "little") + "_endian 1.0\n" +
         kPlyElements + raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, bigEndian) + raw<uint8_t>(4) +
         raw<int32_t>({0, 1, 2, 3}, bigEndian);
}

inline std::string binaryOff() {
  return "OFF BINARY\n" + raw<int32_t>({4, 1, 0}, true) +
         raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, true) + raw<int32_t>({4, 0, 1, 2, 3, 0}, true);
}

/// Corners of a U of area 7, whose fan around most corners closes its mouth.
inline const std::vector<glm::ivec2> kU{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};

/// Returns a line for each corner of the U: `prefix` and three coordinates.
inline std::string cornersOfU(const std::string& prefix = "") {
  std::string lines;
  for (const glm::ivec2& p : kU) lines += prefix + std::to_string(p.x) + " " + std::to_string(p.y) + " 0\n";
  return lines;
}

/// Returns the numbers of the U's corners, from `first` on or backwards from it, plus `offset`.
inline std::string faceOfU(size_t first, bool isReversed, size_t offset = 0) {
  std::string face;
  for (size_t c = 0; c < kU.size(); ++c)
    face += " " + std::to_string((first + (isReversed ? kU.size() - c : c)) % kU.size() + offset);
  return face;
}

/// Returns the sum of the triangles' areas.
inline double areaOf(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

inline bool isU(const Mesh& mesh) {
  return mesh.triangles.size() == 6 && std::abs(areaOf(mesh) - 7.0) < 1e-6;
}

inline const std::string kOff = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
inline const std::string kObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// Returns the buffer of the glTF files: the square's corners, then its six indices.
inline std::string gltfBuffer() {
  return raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + raw<uint16_t>({0, 1, 2, 0, 2, 3});
}

/// Returns a glTF file. `nodes` and `primitive` are JSON; `buffer` is the content of buffers[0] without its
/// braces.
inline std::string gltf(const std::string& buffer, const std::string& nodes = R"({"mesh":0})",
                        const std::string& primitive = R"("attributes":{"POSITION":0},"indices":1)") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
         R"(],"meshes":[{"primitives":[{)" + primitive + R"(}]}],"accessors":[)" +
         R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)" +
         R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],"bufferViews":[)" +
         R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{)" +
         buffer + "}]}";
}

inline std::string glb(std::string json, const std::string& buffer = gltfBuffer()) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& bytes) { return static_cast<uint32_t>(bytes.size()); };
  return "glTF" + raw<uint32_t>({2, 12 + 8 + size(json) + 8 + size(buffer)}) + raw(size(json)) + "JSON" +
         json + raw(size(buffer)) + std::string("BIN\0", 4) + buffer;
}

inline std::string glb() {
  return glb(gltf(R"("byteLength":60)"));
}

/// Returns `text` with its first `from` replaced, so that tests show what is wrong with a sample.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

using Reader = Mesh (*)(const MeshFile& file);

struct Reading {
  Mesh mesh;
  std::string warnings;  ///< One per line.
};

inline Reading read(Reader reader, const std::string& bytes) {
  Reading result;
  const MeshFile file{std::as_bytes(std::span(bytes)), "sample.mesh",
                      [&](const Warning& warning) { result.warnings.append(warning.message) += '\n'; }};
  result.mesh = reader(file);
  return result;
}

/// Returns the message of the Error that reading throws; empty if it throws none.
inline std::string errorOf(Reader reader, const std::string& bytes) {
  try {
    read(reader, bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Returns the sum of the faces' normals times their areas: (0, 0, 1) for the square.
inline glm::dvec3 areaVector(const Mesh& mesh) {
  glm::dvec3 sum(0.0);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x);
    sum += 0.5 * glm::cross(mesh.position(t.y) - a, mesh.position(t.z) - a);
  }
  return sum;
}

inline bool isSquare(const Mesh& mesh) {
  const Box box = bounds(mesh);
  return mesh.triangles.size() == 2 && box.min == glm::dvec3(0, 0, 0) && box.max == glm::dvec3(1, 1, 0) &&
         areaVector(mesh) == glm::dvec3(0, 0, 1);
}

/// A file, alone in its folder, that is removed when the object ends.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& bytes) : path_(folder_.path() / name) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace raymap::samples
