#pragma once

// What every mesh reader shares: the file in memory, its errors and warnings, and the last steps to a Mesh.

#include <raymap/animation.h>
#include <raymap/buffer.h>
#include <raymap/io.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// A mesh file's bytes. The path is for messages and for finding the files that it names.
struct MeshFile {
  std::span<const std::byte> bytes;
  std::filesystem::path path;
  WarningCallback warn;

  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
  [[noreturn]] void fail(const std::string& what) const;
  void warnThat(const std::string& what) const;
};

// One reader per format; each survives any bytes and throws `Error(Input)` if they make no mesh.
Mesh readPly(const MeshFile& file);
Mesh readStl(const MeshFile& file);
Mesh readOff(const MeshFile& file);
Mesh readObj(const MeshFile& file);
Mesh readGltf(const MeshFile& file);
AnimatedMesh readAnimatedGltf(const MeshFile& file, size_t animation = 0);

/// A file name's ending, with the dot.
std::string lowerExtension(const std::filesystem::path& path);

/// Throws `Error(File)` if it is none, or `Error(Memory)` if it is too large to read.
uint64_t regularFileSize(const std::filesystem::path& path);
/// The whole of a regular file. Throws `Error(File)` or `Error(Memory)`.
Buffer<std::byte> loadFile(const std::filesystem::path& path);

/// Throws `Error(Memory)` if `bytes` is more than half of the machine's memory: for sizes that a small file
/// can make large (instances).
void checkMemory(const MeshFile& file, uint64_t bytes);

/// Cuts a polygon into a fan of triangles around its first corner.
void appendFan(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles);
/// A strip's triangles with every second one turned back; those that only join two strips are dropped.
void appendStrip(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles);

/// `whole` = "12 faces", "1 face".
std::string counted(uint64_t count, std::string_view noun);
std::string outOfRange(int64_t vertex, uint64_t vertexCount);

/// Says how many polygons had no triangle in them, if any.
void warnDropped(const MeshFile& file, uint64_t polygons);

/// Checks that there is a triangle and that all used vertices are finite, then centres the mesh on its bounds
/// in double precision. Single-precision positions are moved in place: no second array.
Mesh finishMesh(const MeshFile& file, std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles);
Mesh finishMesh(const MeshFile& file, std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles);

}  // namespace raymap
