#include "io/mesh/mesh_file.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cfloat>
#include <charconv>
#include <cstdio>
#include <memory>
#include <system_error>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/text.h"
#include "mesh/far_vertices.h"
#include "mesh/single_origin.h"

namespace raymap {

namespace {

[[noreturn]] void failRead(const std::filesystem::path& path, const std::string& why) {
  throw Error(ErrorCode::File, path.string() + ": cannot read it: " + why);
}

[[noreturn]] void failTooLarge(const std::filesystem::path& path, uint64_t bytes, uint64_t most) {
  throw Error(ErrorCode::Memory, path.string() + ": reading it needs " + neededText(bytes) +
                                     ", but a file may take only " + limitText(most) + " here");
}

template <class Vec>
bool isFinite(const Vec& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

constexpr size_t kTrianglesPerTask = size_t{1} << 15;

/// Bounds of some triangles, and the first one that has a vertex that is not finite.
template <class Vec>
struct Extent {
  Vec low{INFINITY}, high{-INFINITY};
  size_t firstBad = SIZE_MAX;
};

template <class Vec>
Extent<Vec> extentOf(const std::vector<Vec>& positions, const std::vector<glm::uvec3>& triangles,
                     size_t begin, size_t end) {
  Extent<Vec> extent;
  for (size_t t = begin; t < end; ++t)
    for (int c = 0; c < 3; ++c) {
      const Vec& p = positions[triangles[t][c]];
      if (!isFinite(p)) extent.firstBad = std::min(extent.firstBad, t);
      extent.low = glm::min(extent.low, p);
      extent.high = glm::max(extent.high, p);
    }
  return extent;
}

template <class Vec>
[[noreturn]] void failNotFinite(const MeshFile& file, const std::vector<Vec>& positions,
                                const std::vector<glm::uvec3>& triangles, size_t t) {
  int c = 0;
  while (isFinite(positions[triangles[t][c]])) ++c;
  const Vec& p = positions[triangles[t][c]];
  file.fail("vertex " + std::to_string(triangles[t][c]) + " (used by triangle " + std::to_string(t) +
            ") is not finite: (" + numberText(p.x) + ", " + numberText(p.y) + ", " + numberText(p.z) + ")");
}

/// Returns the bounds of the vertices in use. Throws unless they are finite and their size fits single
/// precision.
template <class Vec>
Box checkedBounds(const MeshFile& file, const std::vector<Vec>& positions,
                  const std::vector<glm::uvec3>& triangles) {
  if (triangles.empty() && file.allowEmpty) return {glm::dvec3(0.0), glm::dvec3(0.0)};
  if (triangles.empty()) file.fail("the file has no triangles");
  if (triangles.size() >= UINT32_MAX || positions.size() >= UINT32_MAX)
    throw Error(ErrorCode::Unsupported, file.path.string() + ": more than 2^32 triangles or vertices");
  std::vector<Extent<Vec>> extents((triangles.size() + kTrianglesPerTask - 1) / kTrianglesPerTask);
  parallelFor(extents.size(), 1, [&](size_t task, size_t) {
    extents[task] = extentOf(positions, triangles, task * kTrianglesPerTask,
                             std::min((task + 1) * kTrianglesPerTask, triangles.size()));
  });
  Vec low(INFINITY), high(-INFINITY);
  for (const Extent<Vec>& extent : extents) {
    if (extent.firstBad != SIZE_MAX) failNotFinite(file, positions, triangles, extent.firstBad);
    low = glm::min(low, extent.low);
    high = glm::max(high, extent.high);
  }
  const Box box{glm::dvec3(low), glm::dvec3(high)};
  const glm::dvec3 size = box.size();
  if (!(std::max({size.x, size.y, size.z}) < FLT_MAX))
    file.fail("its vertices lie too far apart for single precision");
  return box;
}

}  // namespace

void MeshFile::fail(const std::string& what) const {
  throw Error(ErrorCode::Input, path.string() + ": " + what);
}

void MeshFile::warnThat(const std::string& what) const {
  if (warn) warn({WarningCode::FileContent, path.string() + ": " + what, {.file = path.string()}});
}

std::string lowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

uint64_t regularFileSize(const SourceFile& source) {
  const std::filesystem::path& path = source.path();
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(source.place(), error);
  if (error) failRead(path, error.message());
  if (std::filesystem::is_directory(status)) failRead(path, "it is a folder");
  if (!std::filesystem::is_regular_file(status)) failRead(path, "it is not a regular file");
  const uint64_t size = std::filesystem::file_size(source.place(), error);
  if (error) failRead(path, error.message());
  if (const uint64_t most = mostFileBytes(); size > most) failTooLarge(path, size, most);
  return size;
}

Buffer<std::byte> loadFile(const SourceFile& source) {
  const std::filesystem::path& path = source.path();
  const uint64_t size = regularFileSize(source);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(source.place().c_str(), "rb"),
                                                             &std::fclose);
  if (!file) failRead(path, std::generic_category().message(errno));
  std::setvbuf(file.get(), nullptr, _IONBF, 0);
  Buffer<std::byte> bytes(size);
  errno = 0;
  if (std::fread(bytes.data(), 1, size, file.get()) != size)
    failRead(path, errno != 0 ? std::generic_category().message(errno) : "it shrank while being read");
  return bytes;
}

void checkMemory(const MeshFile& file, uint64_t bytes) {
  if (bytes > file.memory) failTooLarge(file.path, bytes, file.memory);
}

void checkExpansion(const MeshFile& file, uint64_t bytes, uint64_t fileBytes) {
  checkMemory(file, bytes);
  // Hundreds of instances of most of a file, or data that are compressed to a hundredth.
  if (const uint64_t most = mostInflated(fileBytes); bytes > most)
    file.fail("its " + counted(fileBytes, "byte") + " stand for at least " + std::to_string(bytes >> 20) +
              " MiB of vertices and triangles, as instances or compressed; of a file of this size at most " +
              std::to_string(most >> 20) +
              " MiB are read; export fewer instances, or write each as a mesh of its own");
}

std::string unescapedUri(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    unsigned char code = 0;
    const bool isEscape = uri[i] == '%' && i + 3 <= uri.size() &&
                          std::from_chars(&uri[i + 1], &uri[i] + 3, code, 16).ptr == &uri[i] + 3;
    text += isEscape ? static_cast<char>(code) : uri[i];
    if (isEscape) i += 2;
  }
  return text;
}

void appendFan(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles) {
  for (size_t i = 2; i < corners.size(); ++i) triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
}

void appendStrip(std::span<const uint32_t> corners, std::vector<glm::uvec3>& triangles) {
  for (size_t i = 2; i < corners.size(); ++i) {
    const uint32_t a = corners[i - 2], b = corners[i - 1], c = corners[i];
    if (a == b || b == c || c == a) continue;
    if (i % 2 == 0)
      triangles.emplace_back(a, b, c);
    else
      triangles.emplace_back(b, a, c);
  }
}

std::string counted(uint64_t count, std::string_view noun) {
  std::string text = std::to_string(count) + " ";
  text += noun;
  if (count == 1) return text;
  if (noun == "vertex") return std::to_string(count) + " vertices";
  return text + "s";
}

std::string outOfRange(int64_t vertex, uint64_t vertexCount) {
  return "vertex index " + std::to_string(vertex) + " is out of range (the file has " +
         counted(vertexCount, "vertex") + ")";
}

void warnOfPolygons(const MeshFile& file, size_t dropped, size_t uncut) {
  if (dropped > 0) file.warnThat(counted(dropped, "face") + " with fewer than three corners dropped");
  if (uncut == 1)
    file.warnThat("1 face crosses itself, or its corners lie on a line: its triangles may overlap");
  else if (uncut > 1)
    file.warnThat(counted(uncut, "face") +
                  " cross themselves, or their corners lie on a line: their triangles may overlap");
}

namespace {

/// Warns of vertices that lie far from all others.
void warnOfFar(const MeshFile& file, const FarVertices& far, const glm::dvec3& farthest) {
  if (far.count == 0 || !file.warn) return;
  std::string what = counted(far.count, "vertex") + (far.count == 1 ? " lies" : " lie") +
                     " 10^9 sizes of the mesh or more away from the others: ";
  if (far.count > 1) what += "the farthest is ";
  what += "vertex " + std::to_string(far.vertex) + " (used by triangle " + std::to_string(far.face) +
          ") at (" + numberText(farthest.x) + ", " + numberText(farthest.y) + ", " + numberText(farthest.z) +
          "), " + numberText(far.distance / far.size, 3) + " sizes away; correct it, or remove its faces";
  file.warn({WarningCode::FarVertices,
             file.path.string() + ": " + what,
             {.file = file.path.string(), .count = far.count, .length = far.distance}});
}

/// Returns whether single precision about an origin holds all positions bit for bit: -0 is another one than
/// 0.
template <class Vec>
bool holdsBits(const std::vector<Vec>& positions, const glm::dvec3& origin) {
  std::atomic<bool> holds{true};
  parallelFor(positions.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end && holds; ++v) {
      const glm::dvec3 given(positions[v]), held = origin + glm::dvec3(roundedToSingle(given - origin));
      using Bits = std::array<uint64_t, 3>;
      if (std::bit_cast<Bits>(held) != std::bit_cast<Bits>(given)) holds = false;
    }
  });
  return holds;
}

/// Rounds positions to single precision about an origin. Floats are moved in place, without a second array.
std::vector<glm::vec3> roundedAbout(const glm::dvec3& origin, std::vector<glm::vec3> positions) {
  parallelFor(positions.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) positions[v] = roundedToSingle(glm::dvec3(positions[v]) - origin);
  });
  return positions;
}

std::vector<glm::vec3> roundedAbout(const glm::dvec3& origin, const std::vector<glm::dvec3>& positions) {
  std::vector<glm::vec3> rounded(positions.size());
  parallelFor(positions.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) rounded[v] = roundedToSingle(positions[v] - origin);
  });
  return rounded;
}

/// Checks positions, and rounds them about an origin. Hands them over if that changes any.
template <class Vec>
Mesh finish(const MeshFile& file, std::vector<Vec> positions, std::vector<glm::uvec3> triangles,
            const glm::dvec3* known = nullptr) {
  const Box bounds = checkedBounds(file, positions, triangles);
  const FarVertices far =
      findFarVertices(bounds, std::span<const Vec>(positions), std::span<const glm::uvec3>(triangles));
  if (far.count > 0) warnOfFar(file, far, glm::dvec3(positions[far.vertex]));
  // Single precision keeps the others only without the far ones, which it keeps as well as any.
  const glm::dvec3 origin = singleOrigin(
      far.others, positions.size(), [&](size_t v) { return positions[v]; }, known, kNoiseAboutZero);
  if (file.exact) file.exact->clear();
  if (file.exact && !holdsBits(positions, origin)) file.exact->assign(positions.begin(), positions.end());
  return {roundedAbout(origin, std::move(positions)), std::move(triangles), origin};
}

}  // namespace

Mesh finishMesh(const MeshFile& file, std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  return finish(file, std::move(positions), std::move(triangles));
}

Mesh finishMesh(const MeshFile& file, std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles,
                const glm::dvec3* knownOrigin) {
  return finish(file, std::move(positions), std::move(triangles), knownOrigin);
}

}  // namespace raymap
