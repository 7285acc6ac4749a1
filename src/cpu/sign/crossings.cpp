// Krayer & Müller 2019, §3.5: the local intersection counts w_l.
//
// Paper: each cell intersects the triangles it holds, in eight passes, in floating point. Here: each triangle
// is scanned over the lattice lines in its projection, because the cost is then that of the crossings, not of
// the cells. It is scanned in exact integers with simulation of simplicity (Edelsbrunner & Mücke 1990),
// because neighbouring triangles then never disagree about a line.

#include "cpu/sign/crossings.h"

#include "base/parallel.h"
#include "cpu/sign/crossings_lines.h"
#include "method/crossings_shared.h"

#include <raymap/error.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "base/text.h"

namespace raymap::cpu {

namespace {

constexpr size_t kTrianglesPerChunk = 4096;
// Number of records of all chunks at which they are merged into the lines. It keeps memory bounded by the
// samples even if millions of triangles cover the whole grid.
constexpr size_t kRecordsPerRound = size_t{1} << 22;
constexpr size_t kRecordsPerReport = size_t{1} << 12;

/// Range of triangles. Those before `next` have been scanned.
struct Chunk {
  size_t next, end;
};

/// Lattice over which triangles are scanned, in units of 2^-fractionBits cells.
struct Lattice {
  glm::ivec3 dims;
  int fractionBits;

  double scale() const { return std::ldexp(1.0, fractionBits); }

  /// Returns the first line at or after the coordinate. Lines are displaced by a positive infinitesimal. So
  /// this is both the first line of a range that begins there and the first line after one that ends there.
  int64_t lineFrom(int64_t coordinate) const {
    return (coordinate + (int64_t{1} << fractionBits) - 1) >> fractionBits;
  }
};

size_t chunkCount(std::span<const glm::uvec3> triangles) {
  return (triangles.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk;
}

/// Returns the largest magnitude of a point's coordinates.
float reach(const glm::vec3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

[[noreturn]] void throwTooFar(const CellMesh& mesh, float limit) {
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const float furthest = reach(mesh.corner(t, c));
      if (!(furthest < limit))
        throw Error(ErrorCode::Input, "vertex " + std::to_string(mesh.triangles[t][c]) + " of triangle " +
                                          std::to_string(t) + " lies " + numberText(furthest) +
                                          " cells from the grid's first sample; the sign needs less than 2^" +
                                          std::to_string(kCoordinateBits) +
                                          ": use a coarser grid or remove the vertex");
    }
  throw Error(ErrorCode::Input, "a vertex lies too far from the grid");
}

/// Calls `work(chunk, triangle)` for all triangles. Chunks run in parallel, each of them in order.
template <class Work>
void forEachTriangle(const CellMesh& mesh, Work&& work) {
  const size_t count = mesh.triangles.size();
  parallelFor(chunkCount(mesh.triangles), 1, [&](size_t chunk, size_t) {
    const size_t end = std::min((chunk + 1) * kTrianglesPerChunk, count);
    for (size_t t = chunk * kTrianglesPerChunk; t < end; ++t) work(chunk, t);
  });
}

/// Returns the largest magnitude of all triangles' coordinates, at least 1.
float furthestCoordinate(const CellMesh& mesh) {
  std::vector<float> reaches(chunkCount(mesh.triangles), 1.0f);
  forEachTriangle(mesh, [&](size_t chunk, size_t t) {
    for (int c = 0; c < 3; ++c) reaches[chunk] = std::max(reaches[chunk], reach(mesh.corner(t, c)));
  });
  return reaches.empty() ? 1.0f : *std::max_element(reaches.begin(), reaches.end());
}

/// Returns the number of fraction bits: the most, up to 20, that leave every coordinate below 2^40. Throws
/// `Error(Input)` if none do.
int chooseFractionBits(const CellMesh& mesh) {
  const float near = std::ldexp(1.0f, kCoordinateBits - kMaxFractionBits),
              far = std::ldexp(1.0f, kCoordinateBits);
  if (std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                  [near](const glm::vec3& v) { return reach(v) < near; }))
    return kMaxFractionBits;
  // Vertices that no triangle uses are ignored.
  const float furthest = furthestCoordinate(mesh);
  if (!(furthest < far)) throwTooFar(mesh, far);
  return std::clamp(kCoordinateBits - 1 - std::ilogb(furthest), 0, kMaxFractionBits);
}

FixedVertex snap(const glm::vec3& p, double scale) {
  const auto round = [&](float x) {
    const double scaled = double(x) * scale;
    return static_cast<int64_t>(scaled + (scaled < 0.0 ? -0.5 : 0.5));
  };
  return {round(p.x), round(p.y), round(p.z)};
}

struct LineRange {
  int64_t begin, end;
  bool isEmpty() const { return begin >= end; }
};

LineRange linesOf(int64_t a, int64_t b, int64_t c, int dim, const Lattice& lattice) {
  return {std::max<int64_t>(lattice.lineFrom(std::min({a, b, c})), 0),
          std::min<int64_t>(lattice.lineFrom(std::max({a, b, c})), dim)};
}

/// Records the crossings of one triangle with the lines along `axis` in the given ranges.
template <class Wide>
void scanTriangle(std::array<FixedVertex, 3> p, int axis, LineRange us, LineRange vs, const Lattice& lattice,
                  std::vector<LineRecord>& records) {
  const LineAxes axes(axis);
  const Wide area = Wide(p[1][axes.u] - p[0][axes.u]) * (p[2][axes.v] - p[0][axes.v]) -
                    Wide(p[1][axes.v] - p[0][axes.v]) * (p[2][axes.u] - p[0][axes.u]);
  if (area == 0) return;  // The displaced lattice lines miss a triangle that projects to a line.
  if (area < 0) std::swap(p[1], p[2]);
  // (u, v, axis) is a left-handed frame for the y axis.
  const int32_t sign = (area > 0) == (axis != 1) ? 1 : -1;
  const int bits = lattice.fractionBits;
  const std::array<EdgeFunction<Wide>, 3> edges{
      {{p[0], p[1], axes, bits}, {p[1], p[2], axes, bits}, {p[2], p[0], axes, bits}}};
  const DepthFunction<Wide> depth(p, axis, axes, bits);
  constexpr int64_t kLongRow = 8;
  for (int64_t v = vs.begin; v < vs.end; ++v) {
    int64_t begin = us.begin, end = us.end;
    if (end - begin > kLongRow)
      for (const auto& edge : edges) edge.narrow(v, begin, end);
    Wide e0 = edges[0].at(begin, v), e1 = edges[1].at(begin, v), e2 = edges[2].at(begin, v);
    for (int64_t u = begin; u < end; ++u) {
      if (e0 > 0 && e1 > 0 && e2 > 0) {
        const int64_t index = std::clamp<int64_t>(depth.lastBelow(u, v), -1, lattice.dims[axis] - 1);
        records.push_back(
            {static_cast<uint32_t>(v * lattice.dims[axes.u] + u), static_cast<int32_t>(index), sign});
      }
      e0 += edges[0].stepU();
      e1 += edges[1].stepU();
      e2 += edges[2].stepU();
    }
  }
}

void scanTriangle(const std::array<FixedVertex, 3>& p, const Lattice& lattice, LineRecords& records) {
  std::array<LineRange, 3> lines{};
  int64_t extent = 0;
  for (int c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax({p[0][c], p[1][c], p[2][c]});
    lines[c] = linesOf(p[0][c], p[1][c], p[2][c], lattice.dims[c], lattice);
    extent = std::max(extent, high - low);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes axes(axis);
    const LineRange us = lines[axes.u], vs = lines[axes.v];
    if (us.isEmpty() || vs.isEmpty()) continue;
    if (extent < (int64_t{1} << kNarrowBits))
      scanTriangle<int64_t>(p, axis, us, vs, lattice, records[axis]);
    else
      scanTriangle<Int128>(p, axis, us, vs, lattice, records[axis]);
  }
}

/// Tests whether a triangle surely crosses no line, before its corners are snapped. Most triangles of a mesh
/// finer than the grid cross none. To cross a line along an axis, a triangle must reach a line number along
/// each of the other two axes.
class MissTest {
 public:
  explicit MissTest(const Lattice& lattice)
      : limit_(lattice.dims),
        margin_(static_cast<float>(2.0 / lattice.scale()) + std::ldexp(reach(lattice.dims), -21)) {}

  bool operator()(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const {
    const auto cell = [&](const glm::vec3& p) {
      return glm::ivec3(glm::clamp(p + 1.0f, glm::vec3(0.0f), limit_));
    };
    const glm::ivec3 low = cell(glm::min(glm::min(a, b), c) - margin_);
    const glm::ivec3 high = cell(glm::max(glm::max(a, b), c) + margin_);
    return (low.x != high.x) + (low.y != high.y) + (low.z != high.z) < 2;
  }

 private:
  glm::vec3 limit_;
  float margin_;  // more than snapping and rounding may move a corner
};

/// Scans triangles until the chunk is done or all chunks together have `kRecordsPerRound` records.
void scanChunk(const Buffer<glm::vec3>& vertices, std::span<const glm::uvec3> triangles,
               const Lattice& lattice, Progress& progress, std::atomic<size_t>& found, Chunk& chunk,
               LineRecords& records) {
  const auto report = [&] { progress.report(double(chunk.next) / double(triangles.size())); };
  report();
  const double scale = lattice.scale();
  const MissTest misses(lattice);
  size_t reported = 0;
  while (chunk.next < chunk.end && found < kRecordsPerRound) {
    const glm::uvec3& t = triangles[chunk.next++];
    const glm::vec3 a = vertices[t.x], b = vertices[t.y], c = vertices[t.z];
    if (misses(a, b, c)) continue;
    scanTriangle({snap(a, scale), snap(b, scale), snap(c, scale)}, lattice, records);
    const size_t count = records[0].size() + records[1].size() + records[2].size();
    if (count - reported < kRecordsPerReport) continue;
    found += count - std::exchange(reported, count);
    report();
  }
}

/// Adds the crossings of some of the mesh's triangles.
void addCrossings(const CellMesh& mesh, std::span<const glm::uvec3> triangles, const Lattice& lattice,
                  RecordWeights weights, Progress& progress, Crossings& crossings) {
  std::vector<Chunk> chunks(chunkCount(triangles));
  for (size_t c = 0; c < chunks.size(); ++c)
    chunks[c] = {c * kTrianglesPerChunk, std::min((c + 1) * kTrianglesPerChunk, triangles.size())};
  std::vector<LineRecords> records(chunks.size());
  const auto isDone = [](const Chunk& chunk) { return chunk.next == chunk.end; };
  while (!std::all_of(chunks.begin(), chunks.end(), isDone)) {
    std::atomic<size_t> found{0};
    parallelFor(chunks.size(), 1, [&](size_t c, size_t) {
      for (auto& list : records[c]) list.clear();
      scanChunk(mesh.vertices, triangles, lattice, progress, found, chunks[c], records[c]);
    });
    for (int axis = 0; axis < 3; ++axis) addToLines(records, axis, weights, crossings[axis]);
  }
}

}  // namespace

size_t crossingBytesExpected(const glm::ivec3& dims) {
  // While they are sorted, a line has a copy of its start, and its length.
  constexpr size_t kOfLine = 2 * sizeof(uint64_t) + sizeof(uint32_t);
  return lineCount(dims) * (kOfLine + kExpectedCrossings * (sizeof(LineRecord) + sizeof(Crossing)));
}

void clearCrossings(const glm::ivec3& dims, Crossings& crossings) {
  for (int axis = 0; axis < 3; ++axis) clearLines(lineCount(dims, axis), crossings[axis]);
}

void countCrossings(const CellMesh& mesh, Progress& progress, Crossings& crossings) {
  clearCrossings(mesh.dims, crossings);
  addCrossings(mesh, mesh.triangles, {mesh.dims, chooseFractionBits(mesh)}, {1, 1}, progress, crossings);
}

void changeCrossings(const CellMesh& mesh, const ChangedFaces& changed, Progress& progress,
                     Crossings& crossings) {
  const Lattice lattice{mesh.dims, chooseFractionBits(mesh)};
  addCrossings(mesh, changed.removed, lattice, {-1, -1}, progress, crossings);
  addCrossings(mesh, changed.added, lattice, {1, 1}, progress, crossings);
  addCrossings(mesh, changed.reversed, lattice, {2, 0}, progress, crossings);
}

}  // namespace raymap::cpu
