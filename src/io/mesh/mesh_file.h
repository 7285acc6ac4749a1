#pragma once

// Shared by all mesh readers: the file in memory, its errors and warnings, and the last steps to a Mesh.

#include <raymap/animation.h>
#include <raymap/buffer.h>
#include <raymap/callbacks.h>
#include <raymap/mesh_attributes.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/source_file.h"
#include "mesh/polygons.h"

namespace raymap {

/// A mesh file in memory. The path is used in messages.
struct MeshFile {
  std::span<const std::byte> bytes;
  std::filesystem::path path;
  WarningCallback warn;
  std::filesystem::path folder = path.parent_path();  ///< Folder of the files that the mesh file refers to.
  bool allowEmpty = false;                            ///< Whether it may have no triangles.
  std::vector<glm::dvec3>* exact = nullptr;           ///< `ReadOptions::exact`.
  uint64_t memory = mostFileBytes();                  ///< Most bytes of what it expands to.
  MeshAttributes* attributes = nullptr;               ///< `ReadOptions::attributes`.

  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
  [[noreturn]] void fail(const std::string& what) const;
  void warnThat(const std::string& what) const;
};

// One reader per format. No input may crash a reader; it throws `Error(Input)` if the bytes make no mesh.
Mesh readPly(const MeshFile& file);
Mesh readStl(const MeshFile& file);
Mesh readOff(const MeshFile& file);
Mesh readObj(const MeshFile& file);
Mesh readGltf(const MeshFile& file);
Mesh read3mf(const MeshFile& file);
/// Reads a glTF as its joints stand without an animation.
Mesh readStandingGltf(const MeshFile& file);
AnimatedMesh readAnimatedGltf(const MeshFile& file, size_t animation = 0);
AnimatedMesh readAnimatedGltf(const MeshFile& file, const std::string& clip);

/// Reads the positions of a PLY's vertices alone, whether there are faces or not.
std::vector<glm::dvec3> readPlyPoints(const MeshFile& file);

/// Returns a file name's extension in lower case, with the dot.
std::string lowerExtension(const std::filesystem::path& path);

/// Returns the size of a file, in bytes. Throws `Error(File)` if it is neither a regular file nor came
/// through a pipe, `Error(Memory)` if it is too large to read.
uint64_t regularFileSize(const SourceFile& source);
/// Reads a whole file. Throws `Error(File)` or `Error(Memory)`.
Buffer<std::byte> loadFile(const SourceFile& source);

/// Throws `Error(Memory)` if `bytes` is more than `MeshFile::memory`. Used for sizes that a small
/// file can make large.
void checkMemory(const MeshFile& file, uint64_t bytes);
/// Throws as well, `Error(Input)`, if `bytes` is far more than `fileBytes` bytes of instances and compressed
/// data amount to: a small file must not take minutes.
inline constexpr uint64_t kBytesPerInstance = 1024;  ///< Least size of an instance in that sum.
void checkExpansion(const MeshFile& file, uint64_t bytes, uint64_t fileBytes);

/// Returns a URI with its escapes (%20) replaced by the bytes that they mean.
std::string unescapedUri(std::string_view uri);

/// Appends a fan of triangles around its first corner.
void appendFan(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles);
/// Appends a strip's triangles, every second one reversed. Drops degenerate triangles, which only join two
/// strips.
void appendStrip(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles);

/// Returns a count with its noun: "12 faces", "1 face".
std::string counted(uint64_t count, std::string_view noun);
std::string outOfRange(int64_t vertex, uint64_t vertexCount);

/// Checks that there is a triangle, unless the file may be empty, and that all used vertices are finite. Then
/// rounds positions to single precision about an origin (`singleOrigin`), and fills `MeshFile::exact`. Warns
/// of vertices that lie far from all others. Single-precision positions are moved in place.
Mesh finishMesh(const MeshFile& file, std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles);
/// `knownOrigin` is one that may keep all positions.
Mesh finishMesh(const MeshFile& file, std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles,
                const glm::dvec3* knownOrigin = nullptr);

/// Warns of polygons that were dropped, or that could not be cut, if there are any.
void warnOfPolygons(const MeshFile& file, size_t dropped, size_t uncut);
/// Warns of polygons with fewer than three corners, and of those that cannot be cut, then finishes their
/// mesh. All vertices must exist.
template <class Vec>
Mesh finishPolygons(const MeshFile& file, std::vector<Vec> positions, Polygons polygons) {
  warnOfPolygons(file, polygons.dropped(), polygons.cut(positions));
  return finishMesh(file, std::move(positions), std::move(polygons.triangles));
}

}  // namespace raymap
