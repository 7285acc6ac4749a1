// Krayer & Müller 2019, §3.5: the local intersection counts w_l.
//
// Paper: each cell intersects the triangles it holds, in eight passes, in floating point. Here: each triangle
// is scanned over the lattice lines in its projection, in exact integers with simulation of simplicity
// (Edelsbrunner & Mücke 1990), because then neighbouring triangles never disagree about a line, and the cost
// is that of the crossings and not of the cells.

#include "crossings.h"

#include "parallel.h"

#include <raymap/error.h>

#include <atomic>
#include <cmath>
#include <string>
#include <vector>

namespace raymap {

namespace {

__extension__ using Int128 = __int128;
using FixedVertex = glm::i64vec3;

constexpr size_t kTrianglesPerChunk = 4096;
constexpr size_t kLinesPerTask = 4096;
constexpr int kMaxFractionBits = 20;
constexpr int kCoordinateBits = 40;  // |coordinate| < 2^40, so that orient3d fits into 128 bits
constexpr int64_t kNarrowExtent = int64_t{1} << 30;  // up to here orient2d fits into 64 bits

struct Record {
  uint32_t line;
  int32_t index;
  int32_t sign;
};
using ChunkRecords = std::array<std::vector<Record>, 3>;

/// The lattice that triangles are scanned over, in units of 2^-fractionBits cells.
struct Lattice {
  glm::ivec3 dims;
  int fractionBits;

  /// The first line at or after the coordinate. Lines are displaced by a positive infinitesimal, so this is
  /// both the first line that a range reaches and the first that it no longer reaches.
  int64_t lineFrom(int64_t coordinate) const {
    return (coordinate + (int64_t{1} << fractionBits) - 1) >> fractionBits;
  }
};

size_t chunkCount(const CellMesh& mesh) {
  return (mesh.triangles.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk;
}

[[noreturn]] void throwTooFar(const CellMesh& mesh, float limit) {
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 p = glm::abs(mesh.corner(t, c));
      const float reach = std::max({p.x, p.y, p.z});
      if (!(reach < limit))
        throw Error(ErrorCode::Input, "vertex " + std::to_string(mesh.triangles[t][c]) + " of triangle " +
                                          std::to_string(t) + " lies " + std::to_string(reach) +
                                          " cells from the grid's first sample; the sign needs less than 2^" +
                                          std::to_string(kCoordinateBits) +
                                          ": use a coarser grid or remove the vertex");
    }
  throw Error(ErrorCode::Input, "a vertex lies too far from the grid");
}

/// Calls `work(chunk, triangle)` for all triangles, chunks in parallel and each in order.
template <class Work>
void forEachTriangle(const CellMesh& mesh, Work&& work) {
  const size_t count = mesh.triangles.size();
  parallelFor(chunkCount(mesh), 1, [&](size_t chunk, size_t) {
    const size_t end = std::min((chunk + 1) * kTrianglesPerChunk, count);
    for (size_t t = chunk * kTrianglesPerChunk; t < end; ++t) work(chunk, t);
  });
}

/// As many fraction bits, up to 20, as leave every coordinate below 2^40.
int chooseFractionBits(const CellMesh& mesh) {
  std::vector<float> reaches(chunkCount(mesh), 1.0f);
  forEachTriangle(mesh, [&](size_t chunk, size_t t) {
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 p = glm::abs(mesh.corner(t, c));
      reaches[chunk] = std::max({reaches[chunk], p.x, p.y, p.z});
    }
  });
  const float reach = reaches.empty() ? 1.0f : *std::max_element(reaches.begin(), reaches.end());
  const float limit = std::ldexp(1.0f, kCoordinateBits);
  if (!(reach < limit)) throwTooFar(mesh, limit);
  return std::clamp(kCoordinateBits - 1 - std::ilogb(reach), 0, kMaxFractionBits);
}

FixedVertex snap(const glm::vec3& p, double scale) {
  const auto round = [&](float x) {
    const double scaled = double(x) * scale;
    return static_cast<int64_t>(scaled + (scaled < 0.0 ? -0.5 : 0.5));
  };
  return {round(p.x), round(p.y), round(p.z)};
}

template <class Wide>
Wide floorDivide(Wide numerator, Wide positiveDenominator) {
  const Wide quotient = numerator / positiveDenominator;
  return quotient - (numerator % positiveDenominator < 0);
}

/// orient2d of a directed edge and the displaced lattice line, positive to the edge's left.
template <class Wide>
class EdgeFunction {
 public:
  EdgeFunction(const FixedVertex& from, const FixedVertex& to, LineAxes axes, int bits)
      : du_(to[axes.u] - from[axes.u]),
        dv_(to[axes.v] - from[axes.v]),
        u_(from[axes.u]),
        v_(from[axes.v]),
        bits_(bits),
        // The displacement adds du * e_v - dv * e_u, and e_u is infinitely larger than e_v.
        tie_(dv_ < 0 || (dv_ == 0 && du_ > 0) ? 1 : 0) {}

  /// Positive for lines to the left of the edge; the tie rule is added in.
  Wide at(int64_t u, int64_t v) const {
    return Wide(du_) * ((v << bits_) - v_) - Wide(dv_) * ((u << bits_) - u_) + tie_;
  }
  Wide stepU() const { return -Wide(dv_) * (Wide(1) << bits_); }

  /// Shrinks [begin, end) of row v to lines that may lie to the left; never drops one that does.
  void narrow(int64_t v, int64_t& begin, int64_t& end) const {
    if (dv_ == 0) return;
    const double crossing =
        std::ldexp(double(u_) + double(du_) * double((v << bits_) - v_) / double(dv_), -bits_);
    if (dv_ > 0)
      end = static_cast<int64_t>(std::clamp(crossing + 2.0, double(begin), double(end)));
    else
      begin = static_cast<int64_t>(std::clamp(crossing - 1.0, double(begin), double(end)));
  }

 private:
  int64_t du_, dv_, u_, v_;
  int bits_;
  int tie_;
};

/// The plane of a triangle, normal towards plus `axis`, for finding the lattice edge that a line crosses.
template <class Wide>
class DepthFunction {
 public:
  DepthFunction(const std::array<FixedVertex, 3>& p, int axis, LineAxes axes, int bits)
      : origin_(p[0]), axis_(axis), axes_(axes), bits_(bits) {
    const FixedVertex a = p[1] - p[0], b = p[2] - p[0];
    normal_ = {Wide(a.y) * b.z - Wide(a.z) * b.y, Wide(a.z) * b.x - Wide(a.x) * b.z,
               Wide(a.x) * b.y - Wide(a.y) * b.x};
    if (normal_[axis] < 0)
      for (Wide& n : normal_) n = -n;
    // The displacement adds n . (e, e^2, e^3): its first component that is not zero decides.
    const Wide first = normal_[0] != 0 ? normal_[0] : normal_[1] != 0 ? normal_[1] : normal_[2];
    tie_ = first > 0 ? 1 : 0;
  }

  /// The last sample of line (u, v) below the plane: the largest i with n . (sample - origin) < 0.
  int64_t lastBelow(int64_t u, int64_t v) const {
    const Int128 across = Int128(normal_[axes_.u]) * ((u << bits_) - origin_[axes_.u]) +
                          Int128(normal_[axes_.v]) * ((v << bits_) - origin_[axes_.v]);
    const auto height = static_cast<int64_t>(floorDivide<Int128>(-across - tie_, normal_[axis_]));
    return (origin_[axis_] + height) >> bits_;
  }

 private:
  FixedVertex origin_;
  std::array<Wide, 3> normal_;
  int axis_;
  LineAxes axes_;
  int bits_;
  int tie_;
};

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
                  std::vector<Record>& records) {
  const LineAxes axes(axis);
  const Wide area = Wide(p[1][axes.u] - p[0][axes.u]) * (p[2][axes.v] - p[0][axes.v]) -
                    Wide(p[1][axes.v] - p[0][axes.v]) * (p[2][axes.u] - p[0][axes.u]);
  if (area == 0) return;  // Projects to a line: the displaced lattice lines miss it.
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

void scanTriangle(const std::array<FixedVertex, 3>& p, const Lattice& lattice, ChunkRecords& records) {
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
    if (extent < kNarrowExtent)
      scanTriangle<int64_t>(p, axis, us, vs, lattice, records[axis]);
    else
      scanTriangle<Int128>(p, axis, us, vs, lattice, records[axis]);
  }
}

std::vector<ChunkRecords> scanTriangles(const CellMesh& mesh, const Lattice& lattice) {
  std::vector<ChunkRecords> chunks(chunkCount(mesh));
  const double scale = std::ldexp(1.0, lattice.fractionBits);
  forEachTriangle(mesh, [&](size_t chunk, size_t t) {
    scanTriangle(
        {snap(mesh.corner(t, 0), scale), snap(mesh.corner(t, 1), scale), snap(mesh.corner(t, 2), scale)},
        lattice, chunks[chunk]);
  });
  return chunks;
}

/// Sorts a line's crossings by index and adds up those with the same one; returns how many are left.
size_t mergeLine(Crossing* begin, Crossing* end) {
  if (begin == end) return 0;
  std::sort(begin, end, [](const Crossing& a, const Crossing& b) { return a.index < b.index; });
  Crossing* last = begin;
  for (Crossing* next = begin + 1; next < end; ++next) {
    if (next->index == last->index) {
      last->signedCount += next->signedCount;
      last->unsignedCount += next->unsignedCount;
    } else {
      *++last = *next;
    }
  }
  return size_t(last + 1 - begin);
}

/// Counting sort by line. The order within a line depends on the threads, so it is sorted afterwards.
void sortByLine(const std::vector<ChunkRecords>& chunks, int axis, size_t lines, AxisCrossings& result) {
  Buffer<uint64_t>& starts = result.starts;
  starts.resize(lines + 1);
  std::fill(starts.begin(), starts.end(), 0);
  const auto forEachRecord = [&](auto&& work) {
    parallelFor(chunks.size(), 1, [&](size_t chunk, size_t) {
      for (const Record& record : chunks[chunk][axis]) work(record);
    });
  };
  forEachRecord(
      [&](const Record& r) { std::atomic_ref(starts[r.line]).fetch_add(1, std::memory_order_relaxed); });
  uint64_t total = 0;
  for (uint64_t& start : starts) total += std::exchange(start, total);
  // starts[line + 1] counts up from the line's begin to its end, which is where the next line begins.
  for (size_t line = lines; line > 0; --line) starts[line] = starts[line - 1];
  result.entries.resize(total);
  forEachRecord([&](const Record& r) {
    const uint64_t at = std::atomic_ref(starts[r.line + 1]).fetch_add(1, std::memory_order_relaxed);
    result.entries[at] = {r.index, r.sign, 1};
  });
}

void mergeLines(size_t lines, AxisCrossings& result) {
  std::vector<uint32_t> lengths(lines);
  parallelFor(lines, kLinesPerTask, [&](size_t begin, size_t end) {
    for (size_t line = begin; line < end; ++line)
      lengths[line] = static_cast<uint32_t>(mergeLine(result.entries.data() + result.starts[line],
                                                      result.entries.data() + result.starts[line + 1]));
  });
  uint64_t to = 0;
  for (size_t line = 0; line < lines; ++line) {
    const uint64_t from = std::exchange(result.starts[line], to);
    for (uint32_t e = 0; e < lengths[line]; ++e) result.entries[to++] = result.entries[from + e];
  }
  result.starts[lines] = to;
  result.entries.resize(to);
}

}  // namespace

void countCrossings(const CellMesh& mesh, Crossings& crossings) {
  const Lattice lattice{mesh.dims, chooseFractionBits(mesh)};
  const std::vector<ChunkRecords> chunks = scanTriangles(mesh, lattice);
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes axes(axis);
    const size_t lines = size_t(mesh.dims[axes.u]) * size_t(mesh.dims[axes.v]);
    sortByLine(chunks, axis, lines, crossings[axis]);
    mergeLines(lines, crossings[axis]);
  }
}

}  // namespace raymap
