// Dual contouring (Ju et al. 2002) with a vertex for each sheet that passes a cube (Nielson 2004).

#include "dual_contour.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <string>

#include "cpu/parallel.h"
#include "cube_cycles.h"
#include "memory.h"

namespace raymap {

namespace {

constexpr size_t kRowsPerTask = 64;
constexpr size_t kVerticesPerTask = size_t{1} << 14;
constexpr double kApart = 0.01;  // Least distance of two vertices in a cube.
constexpr double kFold = 10.0;   // Cost of a triangle turned over,
constexpr double kShape = 1e-4;  // and of an edge over a triangle's height.

/// A cube that the surface passes. Its lowest corner is sample (x - 1, y - 1, z - 1), where y and z are those
/// of its row.
struct Cube {
  int32_t x;
  uint8_t corners;    // Bits of those inside.
  uint8_t ambiguous;  // Bits of faces,
  uint8_t joined;     // and how each is settled, as `CubeCycles` takes it.
  CubeCycles cycles;
  uint32_t firstVertex;
  uint32_t firstQuad;
};

glm::ivec3 along(int axis) {
  glm::ivec3 step(0);
  step[axis % 3] = 1;
  return step;
}

glm::ivec3 cornerOffset(int corner) {
  return {corner & 1, corner >> 1 & 1, corner >> 2};
}

/// The height over the longest edge, as a share of it.
double shapeOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto square = [](const glm::dvec3& v) { return glm::dot(v, v); };
  return glm::length(glm::cross(b - a, c - a)) / std::max({square(b - a), square(c - b), square(a - c)});
}

class Contour {
 public:
  Contour(const Field& field, double iso, const AddPlanes& addPlanes)
      : field_(field),
        iso_(iso),
        addPlanes_(addPlanes),
        dims_(field.grid.dims + 1),
        rowBegin_(size_t(dims_.y) * size_t(dims_.z) + 1),
        middle_(0.5 * glm::dvec3(field.grid.dims - 1)) {}

  Mesh run() {
    findCubes();
    splitDoubledEdges();
    numberAll();
    placeVertices();
    joinVertices();
    return std::move(mesh_);
  }

 private:
  using Quad = std::array<uint32_t, 4>;

  // Cubes.

  double value(const glm::ivec3& sample) const {
    return double(field_.distance[field_.grid.index(sample)]) - iso_;
  }

  template <class Work>
  void forEachRow(Work&& work) const {
    parallelFor(rowBegin_.size() - 1, kRowsPerTask, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) work(row, int(row % dims_.y), int(row / dims_.y));
    });
  }

  template <class Work>
  void forEachCube(Work&& work) {
    forEachRow([&](size_t row, int y, int z) {
      for (size_t c = rowBegin_[row]; c < rowBegin_[row + 1]; ++c)
        work(cubes_[c], glm::ivec3(cubes_[c].x, y, z));
    });
  }

  /// Calls `visit(x, corners)` for each cube of a row that has corners inside and outside.
  template <class Visit>
  void scanRow(int y, int z, Visit&& visit) const {
    const glm::ivec3 last = field_.grid.dims - 1;
    std::array<const float*, 4> samples{};
    for (int r = 0; r < 4; ++r) {
      const int j = y - 1 + (r & 1), k = z - 1 + (r >> 1);
      if (j >= 0 && j <= last.y && k >= 0 && k <= last.z)
        samples[r] = field_.distance.data() + field_.grid.index({0, j, k});
    }
    unsigned low = 0;
    for (int x = 0; x < dims_.x; ++x) {
      unsigned high = 0;
      if (x <= last.x)
        for (int r = 0; r < 4; ++r)
          if (samples[r] && samples[r][x] < iso_) high |= 1u << 2 * r;
      const unsigned corners = low | high << 1;
      if (corners != 0 && corners != 255) visit(x, corners);
      low = high;
    }
  }

  void findCubes() {
    forEachRow(
        [&](size_t row, int y, int z) { scanRow(y, z, [&](int, unsigned) { ++rowBegin_[row + 1]; }); });
    for (size_t row = 1; row < rowBegin_.size(); ++row) rowBegin_[row] += rowBegin_[row - 1];
    cubes_.resize(rowBegin_.back());
    forEachRow([&](size_t row, int y, int z) {
      Cube* cube = cubes_.data() + rowBegin_[row];
      scanRow(y, z, [&](int x, unsigned corners) { *cube++ = makeCube({x, y, z}, corners); });
    });
  }

  Cube makeCube(const glm::ivec3& place, unsigned corners) const {
    const unsigned ambiguous = ambiguousFaces(corners);
    unsigned joined = 0;
    for (int f = 0; ambiguous >> f != 0; ++f)
      if ((ambiguous >> f & 1) != 0 && isJoined(place, corners, kCubeFaceTable[f])) joined |= 1u << f;
    return {place.x,
            static_cast<uint8_t>(corners),
            static_cast<uint8_t>(ambiguous),
            static_cast<uint8_t>(joined),
            CubeCycles(corners, joined),
            0,
            0};
  }

  /// Whether the inside corners of an ambiguous face belong together: as the bilinear value between them has
  /// it (Nielson & Hamann 1991). Both cubes at the face see the same.
  bool isJoined(const glm::ivec3& place, unsigned corners, const CubeFace& face) const {
    const auto at = [&](int i) { return value(place - 1 + cornerOffset(face.corners[i])); };
    const double even = at(0) * at(2), odd = at(1) * at(3);
    const bool isEvenInside = (corners >> face.corners[0] & 1) != 0;
    return isEvenInside ? even > odd : odd > even;
  }

  Cube& cubeAt(const glm::ivec3& place) {
    const size_t row = size_t(place.z) * dims_.y + place.y;
    const auto begin = cubes_.begin() + ptrdiff_t(rowBegin_[row]);
    const auto end = cubes_.begin() + ptrdiff_t(rowBegin_[row + 1]);
    return *std::lower_bound(begin, end, place.x, [](const Cube& cube, int x) { return cube.x < x; });
  }

  /// Where one sheet passes the face between two cubes twice on both sides of it, their two vertices would
  /// be joined by two edges at the same place. Joining the face's other corners makes it two sheets in either
  /// cube. Rare, so in order and on one thread.
  void splitDoubledEdges() {
    for (size_t row = 0; row + 1 < rowBegin_.size(); ++row)
      for (size_t c = rowBegin_[row]; c < rowBegin_[row + 1]; ++c)
        if (cubes_[c].ambiguous != 0)
          splitDoubledEdges(cubes_[c], {cubes_[c].x, int(row % dims_.y), int(row / dims_.y)});
  }

  void splitDoubledEdges(Cube& cube, const glm::ivec3& place) {
    for (int axis = 0; axis < 3; ++axis) {
      const int high = 2 * axis + 1, low = 2 * axis;
      if ((cube.ambiguous >> high & 1) == 0 || !cube.cycles.passTwice(high)) continue;
      Cube& next = cubeAt(place + along(axis));
      if (!next.cycles.passTwice(low)) continue;
      turn(cube, high);
      turn(next, low);
    }
  }

  static void turn(Cube& cube, int face) {
    cube.joined = static_cast<uint8_t>(cube.joined ^ 1u << face);
    cube.cycles = CubeCycles(cube.corners, cube.joined);
  }

  // Vertices and triangles.

  /// An edge of the lattice belongs to the cube that it leaves at the lowest corner.
  static bool isCrossed(const Cube& cube, int axis) {
    return ((cube.corners ^ cube.corners >> (1 << axis)) & 1) != 0;
  }

  void numberAll() {
    size_t vertices = 0, quads = 0;
    for (Cube& cube : cubes_) {
      cube.firstVertex = static_cast<uint32_t>(vertices);
      cube.firstQuad = static_cast<uint32_t>(quads);
      vertices += size_t(cube.cycles.count());
      for (int axis = 0; axis < 3; ++axis) quads += isCrossed(cube, axis) ? 1 : 0;
    }
    const size_t bytes = vertices * (sizeof(glm::vec3) + sizeof(Quadric)) + 2 * quads * sizeof(glm::uvec3);
    if (const size_t left = availableMemory(); bytes > left)
      throw Error(ErrorCode::Memory, "the surface needs " + std::to_string((bytes >> 20) + 1) +
                                         " MiB, but only " + std::to_string(left >> 20) +
                                         " MiB are left; use a lower resolution");
    if (vertices > UINT32_MAX || quads > UINT32_MAX / 2)
      throw Error(ErrorCode::Unsupported, "the surface has more than 2^32 vertices or triangles");
    mesh_.vertices.resize(vertices);
    quadrics_.resize(vertices);
    mesh_.triangles.resize(2 * quads);
  }

  void placeVertices() {
    forEachCube([&](const Cube& cube, const glm::ivec3& place) {
      std::vector<PlaneFit> sheets(size_t(cube.cycles.count()), PlaneFit(place - 1));
      for (int edge = 0; edge < kCubeEdges; ++edge)
        addEdge(cube, place, edge, sheets[size_t(cube.cycles.of(edge))]);
      glm::vec3* vertices = mesh_.vertices.data() + cube.firstVertex;
      for (size_t s = 0; s < sheets.size(); ++s) {
        vertices[s] = glm::vec3(sheets[s].solve() - middle_);
        quadrics_[cube.firstVertex + s] = sheets[s].quadric();
      }
      // Sheets must not meet: the means of their crossings do not.
      for (size_t s = 1; s < sheets.size(); ++s)
        for (size_t t = 0; t < s; ++t)
          if (glm::distance(vertices[s], vertices[t]) < kApart)
            for (const size_t i : {s, t}) vertices[i] = glm::vec3(sheets[i].mean() - middle_);
    });
  }

  void addEdge(const Cube& cube, const glm::ivec3& place, int edge, PlaneFit& fit) const {
    if (!isEdgeCrossed(cube.corners, edge)) return;
    const int from = edgeStart(edge), to = edgeEnd(edge);
    const bool isIn = isCornerInside(cube.corners, from);
    const glm::ivec3 start = place - 1 + cornerOffset(from), end = place - 1 + cornerOffset(to);
    addPlanes_(isIn ? start : end, isIn ? end : start, fit);
  }

  /// A quad across each lattice edge that the surface crosses joins the vertices of the four cubes around.
  void joinVertices() {
    forEachCube([&](const Cube& cube, const glm::ivec3& place) {
      uint32_t triangle = 2 * cube.firstQuad;
      for (int axis = 0; axis < 3; ++axis) {
        if (!isCrossed(cube, axis)) continue;
        const Quad quad = quadAcross(cube, place, axis);
        const int first = diagonalCost(quad, 0, axis) <= diagonalCost(quad, 1, axis) ? 0 : 1;
        const std::array<uint32_t, 4> q{quad[first], quad[first + 1], quad[(first + 2) % 4],
                                        quad[(first + 3) % 4]};
        const bool isUp = (cube.corners & 1) != 0;
        mesh_.triangles[triangle++] = isUp ? glm::uvec3(q[0], q[1], q[2]) : glm::uvec3(q[0], q[2], q[1]);
        mesh_.triangles[triangle++] = isUp ? glm::uvec3(q[0], q[2], q[3]) : glm::uvec3(q[0], q[3], q[2]);
      }
    });
    const double spacing = field_.grid.spacing;
    parallelFor(mesh_.vertices.size(), kVerticesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v)
        mesh_.vertices[v] = glm::vec3(spacing * glm::dvec3(mesh_.vertices[v]));
    });
    mesh_.origin = field_.grid.position(middle_);
  }

  /// Counter-clockwise seen against the axis.
  Quad quadAcross(const Cube& cube, const glm::ivec3& place, int axis) {
    const glm::ivec3 u = along(axis + 1), v = along(axis + 2);
    const auto vertex = [&](const Cube& at, int side) {
      return at.firstVertex + at.cycles.of(4 * axis + side);
    };
    return {vertex(cubeAt(place - u - v), 3), vertex(cubeAt(place - v), 2), vertex(cube, 0),
            vertex(cubeAt(place - u), 1)};
  }

  /// The diagonal from a quad's corner `first` should lie in the surface's planes, above all else turn no
  /// triangle over, and where the surface is flat make good triangles.
  double diagonalCost(const Quad& quad, int first, int axis) const {
    std::array<glm::dvec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = glm::dvec3(mesh_.vertices[quad[(first + i) % 4]]);
    double cost = 0.0;
    for (int i = 0; i < 4; ++i)
      cost += quadrics_[quad[(first + i) % 4]](glm::vec3(0.5 * (p[0] + p[2]) - p[i]));
    for (const int i : {0, 2}) {
      const glm::dvec3 &a = p[i], &b = p[i + 1], &c = p[2 - i];
      if (!(glm::cross(b - a, c - a)[axis] > 0.0)) cost += kFold;
      cost += kShape / std::max(shapeOf(a, b, c), 1e-9);
    }
    return cost;
  }

  const Field& field_;
  double iso_;
  const AddPlanes& addPlanes_;
  glm::ivec3 dims_;  // Of the cubes: one more than the samples.
  std::vector<size_t> rowBegin_;
  std::vector<Cube> cubes_;
  std::vector<Quadric> quadrics_;  // Of each vertex.
  glm::dvec3 middle_;              // Of the grid, in samples: what vertices are counted from.
  Mesh mesh_;                      // In samples, until it is done.
};

}  // namespace

Mesh dualContour(const Field& field, double iso, const AddPlanes& addPlanes) {
  return Contour(field, iso, addPlanes).run();
}

}  // namespace raymap
