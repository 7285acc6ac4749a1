// Dual contouring (Ju et al. 2002) with a vertex for each sheet that passes a cube (Nielson 2004), and
// without faces that cross (Ju & Udeshi 2006).

#include "dual_contour.h"

#include <raymap/diagnostics.h>
#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "contour_cubes.h"
#include "memory.h"

namespace raymap {

namespace {

constexpr size_t kVerticesPerTask = size_t{1} << 14;
constexpr double kApart = 0.01;       // Least distance of two vertices in a cube.
constexpr double kFold = 10.0;        // Cost of a triangle turned over,
constexpr double kShape = 1e-4;       // and of an edge over a triangle's height.
constexpr int kMostRounds = 16;       // Of looking for faces that cross,
constexpr size_t kSearchBytes = 128;  // which takes so much for each.

/// The height over the longest edge, as a share of it.
double shapeOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto square = [](const glm::dvec3& v) { return glm::dot(v, v); };
  return glm::length(glm::cross(b - a, c - a)) / std::max({square(b - a), square(c - b), square(a - c)});
}

class Contour {
 public:
  Contour(const Field& field, double iso, const AddPlanes& addPlanes, Progress& progress)
      : grid_(field.grid),
        addPlanes_(addPlanes),
        middle_(0.5 * glm::dvec3(field.grid.dims - 1)),
        progress_(progress),
        cubes_(field, iso, progress) {}

  Mesh run() {
    reserve();
    progress_.part(0.2, 0.6);
    placeVertices();
    progress_.part(0.6, 0.8);
    joinVertices();
    scale();
    progress_.part(0.8, 1.0);
    uncross();
    return std::move(mesh_);
  }

 private:
  using Quad = std::array<uint32_t, 4>;

  void reserve() {
    const size_t vertices = cubes_.vertexCount(), quads = cubes_.quadCount();
    const size_t bytes =
        vertices * (sizeof(glm::vec3) + sizeof(Quadric)) + 2 * quads * (sizeof(glm::uvec3) + kSearchBytes);
    if (const size_t left = availableMemory(); bytes > left)
      throw Error(ErrorCode::Memory, "the surface needs " + std::to_string((bytes >> 20) + 1) +
                                         " MiB, but only " + std::to_string(left >> 20) +
                                         " MiB are left; use a lower resolution");
    if (vertices + quads > UINT32_MAX || 4 * quads > UINT32_MAX)
      throw Error(ErrorCode::Unsupported, "the surface has more than 2^32 vertices or triangles");
    mesh_.vertices.resize(vertices);
    quadrics_.resize(vertices);
    mesh_.triangles.resize(2 * quads);
  }

  // Vertices.

  std::vector<PlaneFit> fitSheets(const ContourCube& cube, const glm::ivec3& place) const {
    std::vector<PlaneFit> sheets(size_t(cube.cycles.count()), PlaneFit(place - 1));
    for (int edge = 0; edge < kCubeEdges; ++edge)
      if (isEdgeCrossed(cube.corners, edge)) addEdge(cube, place, edge, sheets[size_t(cube.cycles.of(edge))]);
    return sheets;
  }

  void addEdge(const ContourCube& cube, const glm::ivec3& place, int edge, PlaneFit& fit) const {
    const int from = edgeStart(edge), to = edgeEnd(edge);
    const bool isIn = isCornerInside(cube.corners, from);
    const glm::ivec3 start = place - 1 + cornerOffset(from), end = place - 1 + cornerOffset(to);
    addPlanes_(isIn ? start : end, isIn ? end : start, fit);
  }

  void placeVertices() {
    cubes_.forEach([&](const ContourCube& cube, const glm::ivec3& place) {
      const std::vector<PlaneFit> sheets = fitSheets(cube, place);
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

  // Triangles.

  /// A quad across each lattice edge that the surface crosses joins the vertices of the four cubes around.
  void joinVertices() {
    cubes_.forEach([&](const ContourCube& cube, const glm::ivec3& place) {
      uint32_t quad = cube.firstQuad;
      for (int axis = 0; axis < 3; ++axis) {
        if (!cube.isCrossed(axis)) continue;
        Quad q = quadAcross(cube, place, axis);
        if (diagonalCost(q, 1, axis) < diagonalCost(q, 0, axis))
          std::rotate(q.begin(), q.begin() + 1, q.end());
        if (!cube.startsInside()) std::swap(q[1], q[3]);
        mesh_.triangles[2 * quad] = {q[0], q[1], q[2]};
        mesh_.triangles[2 * quad + 1] = {q[0], q[2], q[3]};
        ++quad;
      }
    });
  }

  /// Counter-clockwise seen against the axis.
  Quad quadAcross(const ContourCube& cube, const glm::ivec3& place, int axis) const {
    const glm::ivec3 u = along(axis + 1), v = along(axis + 2);
    const auto vertex = [&](const ContourCube& at, int side) {
      return at.firstVertex + at.cycles.of(4 * axis + side);
    };
    return {vertex(cubes_.at(place - u - v), 3), vertex(cubes_.at(place - v), 2), vertex(cube, 0),
            vertex(cubes_.at(place - u), 1)};
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

  void scale() {
    parallelFor(mesh_.vertices.size(), kVerticesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) mesh_.vertices[v] = scaled(mesh_.vertices[v]);
    });
    mesh_.origin = grid_.position(middle_);
  }
  glm::vec3 scaled(const glm::vec3& samples) const { return glm::vec3(grid_.spacing * glm::dvec3(samples)); }

  // Faces that cross.

  /// What a fan has inside the cubes around its edge stays there: where each of them has one sheet, fans
  /// never cross. Halves of quads do where their diagonal cuts through a fifth cube's part, which is rare, so
  /// quads become fans only where they cross something, and those around them in the next round. What then
  /// still crosses are two sheets in one cube, which their corners pull into each other.
  void uncross() {
    for (int round = 0; round < kMostRounds; ++round) {
      progress_.report(double(round) / kMostRounds);
      const std::vector<uint32_t> faces = findSelfIntersections(mesh_).faces;
      const size_t fans = fans_.size(), levelled = levelled_.size();
      if (!faces.empty() && round == 0) isFan_.resize(cubes_.quadCount());
      const std::vector<bool> wasFan = isFan_;
      for (const uint32_t face : faces) {
        const uint32_t quad = quadOf(face);
        if (!isFan_[quad])
          fan(quad);
        else if (wasFan[quad])
          level(face);
      }
      if (fans_.size() == fans && levelled_.size() == levelled) return;
    }
  }

  uint32_t quadOf(uint32_t face) const {
    const size_t half = face / 2, quads = cubes_.quadCount();
    return half < quads ? uint32_t(half) : fans_[half - quads];
  }

  /// Four triangles around the point where the surface crosses the quad's edge of the lattice.
  void fan(uint32_t quad) {
    const auto [cube, place] = cubes_.ofQuad(quad);
    const auto center = uint32_t(mesh_.vertices.size());
    mesh_.vertices.push_back(scaled(glm::vec3(crossingOf(cube, place, quad - cube.firstQuad) - middle_)));
    glm::uvec3 &first = mesh_.triangles[2 * quad], &second = mesh_.triangles[2 * quad + 1];
    const Quad q{first.x, first.y, first.z, second.z};
    first = {q[0], q[1], center};
    second = {q[1], q[2], center};
    mesh_.triangles.insert(mesh_.triangles.end(), {{q[2], q[3], center}, {q[3], q[0], center}});
    isFan_[quad] = true;
    fans_.push_back(quad);
  }

  /// Not where edges of the lattice meet.
  glm::dvec3 crossingOf(const ContourCube& cube, const glm::ivec3& place, uint32_t number) const {
    int axis = 0;
    for (; !cube.isCrossed(axis) || number > 0; ++axis) number -= cube.isCrossed(axis) ? 1 : 0;
    PlaneFit crossing(place - 1);
    addEdge(cube, place, 4 * axis, crossing);
    glm::dvec3 p = crossing.mean();
    p[axis] = std::clamp(p[axis], place[axis] - 1 + kCubeMargin, place[axis] - kCubeMargin);
    return p;
  }

  /// Puts the sheets of a fan's cubes into the means of their crossings where there are several.
  void level(uint32_t face) {
    for (const uint32_t vertex : {mesh_.triangles[face].x, mesh_.triangles[face].y}) {
      const auto [cube, place] = cubes_.ofVertex(vertex);
      if (cube.cycles.count() == 1 || !levelled_.insert(cube.firstVertex).second) continue;
      const std::vector<PlaneFit> sheets = fitSheets(cube, place);
      for (size_t s = 0; s < sheets.size(); ++s)
        mesh_.vertices[cube.firstVertex + s] = scaled(glm::vec3(sheets[s].mean() - middle_));
    }
  }

  const Grid& grid_;
  const AddPlanes& addPlanes_;
  glm::dvec3 middle_;  // Of the grid, in samples: what vertices are counted from.
  Progress& progress_;
  ContourCubes cubes_;
  std::vector<Quadric> quadrics_;  // Of each vertex.
  Mesh mesh_;                      // In samples, until it is scaled.
  std::vector<bool> isFan_;        // Of each quad, once faces cross.
  std::vector<uint32_t> fans_;     // The quad of each two triangles beyond those of all quads.
  std::set<uint32_t> levelled_;    // First vertices of cubes.
};

}  // namespace

Mesh dualContour(const Field& field, double iso, const AddPlanes& addPlanes, Progress& progress) {
  progress.part(0.0, 0.2);
  return Contour(field, iso, addPlanes, progress).run();
}

}  // namespace raymap
