// Dual contouring (Ju et al. 2002), with one vertex for each sheet that passes a cube (Nielson 2004) and
// without crossing faces (Ju & Udeshi 2006).

#include "isosurface/dual_contour.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <string>

#include "base/memory.h"
#include "isosurface/contour_cubes.h"
#include "isosurface/uncross.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

constexpr double kApart = 0.01;  // Least distance of two vertices in a cube, in samples.
constexpr double kFold = 10.0;   // Cost of a triangle with reversed winding order.
constexpr double kShape = 1e-4;  // Cost of a triangle's shape, divided by `shapeOf`.
constexpr double kLeave = 1e-3;  // Cost of a diagonal whose triangles may cross others.

/// Returns a triangle's height above its longest edge, as a share of that edge.
double shapeOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto square = [](const glm::dvec3& v) { return glm::dot(v, v); };
  return glm::length(doubleAreaNormal(a, b, c)) / std::max({square(b - a), square(c - b), square(a - c)});
}

class Contour {
 public:
  Contour(const Grid& grid, ContourRows cubes, const ContourCubes::SampleValue& value,
          const AddPlanes& addPlanes, Progress& progress, Mesh& result)
      : grid_(grid),
        middle_(0.5 * glm::dvec3(grid.dims - 1)),
        progress_(progress),
        cubes_(std::move(cubes), value, progress),
        sheets_(cubes_, addPlanes),
        mesh_(result) {}

  void run() {
    reserve();
    progress_.part(0.2, 0.6);
    placeVertices();
    progress_.part(0.6, 0.8);
    joinVertices();
    scale();
    progress_.part(0.8, 1.0);
    uncross(cubes_, sheets_, grid_, std::move(isSuspect_), mesh_, progress_);
  }

 private:
  using Quad = std::array<uint32_t, 4>;
  using CubeRing = std::array<const ContourCube*, 4>;
  using Corners = std::array<glm::dvec3, 4>;

  void reserve() {
    const size_t vertices = cubes_.vertexCount(), quads = cubes_.quadCount();
    checkSurfaceMemory(vertices * (sizeof(glm::vec3) + sizeof(Quadric)) + 2 * quads * sizeof(glm::uvec3));
    if (vertices + quads > UINT32_MAX || 4 * quads > UINT32_MAX)
      throw Error(ErrorCode::Unsupported, "the surface has more than 2^32 vertices or triangles");
    mesh_.vertices.resize(vertices);
    quadrics_.resize(vertices);
    mesh_.triangles.resize(2 * quads);
    isSuspect_.resize(quads);
  }

  // Vertices.

  void placeVertices() {
    cubes_.forEach([&](const ContourCube& cube, const glm::ivec3& place) {
      const std::vector<PlaneFit> sheets = sheets_.fit(cube, place);
      glm::vec3* vertices = mesh_.vertices.data() + cube.firstVertex;
      for (size_t s = 0; s < sheets.size(); ++s) {
        vertices[s] = glm::vec3(sheets[s].solve() - middle_);
        quadrics_[cube.firstVertex + s] = sheets[s].quadric();
      }
      // Sheets must not meet. The means of their crossings never do.
      for (size_t s = 1; s < sheets.size(); ++s)
        for (size_t t = 0; t < s; ++t)
          if (glm::distance(vertices[s], vertices[t]) < kApart)
            for (const size_t i : {s, t}) vertices[i] = glm::vec3(sheets[i].mean() - middle_);
    });
  }

  // Triangles.

  /// Joins the vertices of the four cubes around each lattice edge that the surface crosses.
  void joinVertices() {
    cubes_.forEach([&](const ContourCube& cube, const glm::ivec3& place) {
      uint32_t quad = cube.firstQuad;
      for (int axis = 0; axis < 3; ++axis) {
        if (!cube.isCrossed(axis)) continue;
        const auto around = cubesAround(cube, place, axis);
        Quad q = quadAcross(around, axis);
        if (diagonalCost(q, 1, place, axis) < diagonalCost(q, 0, place, axis))
          std::rotate(q.begin(), q.begin() + 1, q.end());
        const bool isCrowded =
            std::ranges::any_of(around, [](const ContourCube* c) { return c->cycles.count() > 1; });
        isSuspect_[quad] = isCrowded || leaves(cornersOf(q, 0), place, axis) ? 1 : 0;
        if (!cube.startsInside()) std::swap(q[1], q[3]);
        mesh_.triangles[2 * quad] = {q[0], q[1], q[2]};
        mesh_.triangles[2 * quad + 1] = {q[0], q[2], q[3]};
        ++quad;
      }
    });
  }

  /// Returns the cubes around an edge that `cube` owns, counter-clockwise as seen against the axis.
  CubeRing cubesAround(const ContourCube& cube, const glm::ivec3& place, int axis) const {
    const glm::ivec3 u = along(axis + 1), v = along(axis + 2);
    return {&cubes_.at(place - u - v), &cubes_.at(place - v), &cube, &cubes_.at(place - u)};
  }

  static Quad quadAcross(const CubeRing& around, int axis) {
    const auto vertex = [&](int at, int side) {
      return around[at]->firstVertex + uint32_t(around[at]->cycles.of(4 * axis + side));
    };
    return {vertex(0, 3), vertex(1, 2), vertex(2, 0), vertex(3, 1)};
  }

  Corners cornersOf(const Quad& quad, int first) const {
    Corners corners;
    for (int i = 0; i < 4; ++i) corners[i] = glm::dvec3(mesh_.vertices[quad[(first + i) % 4]]);
    return corners;
  }

  /// Returns the cost of the diagonal from a quad's corner `first`. Reversed triangles cost most, then
  /// distance from the surface's planes. On a flat surface, triangles that may cross others and badly shaped
  /// ones decide.
  double diagonalCost(const Quad& quad, int first, const glm::ivec3& place, int axis) const {
    const Corners p = cornersOf(quad, first);
    double cost = leaves(p, place, axis) ? kLeave : 0.0;
    for (int i = 0; i < 4; ++i)
      cost += quadrics_[quad[(first + i) % 4]](glm::vec3(0.5 * (p[0] + p[2]) - p[i]));
    for (const int i : {0, 2}) {
      const glm::dvec3 &a = p[i], &b = p[i + 1], &c = p[2 - i];
      if (!(doubleAreaNormal(a, b, c)[axis] > 0.0)) cost += kFold;
      cost += kShape / std::max(shapeOf(a, b, c), 1e-9);
    }
    return cost;
  }

  /// Returns whether the triangles of a quad leave the tetrahedra between its sides and its lattice edge. The
  /// diagonal passes that edge on the side of one of the other two corners. It must do so inside the triangle
  /// from that corner to the edge.
  bool leaves(const Corners& p, const glm::ivec3& place, int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const glm::dvec3 start = glm::dvec3(place - 1) - middle_, from = p[0] - start, to = p[2] - start;
    for (const int side : {1, 3}) {
      const glm::dvec3 corner = p[side] - start;
      const auto turn = [&](const glm::dvec3& d) { return d[u] * corner[v] - d[v] * corner[u]; };
      const glm::dvec3 passed = glm::mix(from, to, turn(from) / (turn(from) - turn(to)));
      const double share =
          (passed[u] * corner[u] + passed[v] * corner[v]) / (corner[u] * corner[u] + corner[v] * corner[v]);
      if (share > 0.0)
        return share > 1.0 || passed[axis] < share * corner[axis] ||
               1.0 - passed[axis] < share * (1.0 - corner[axis]);
    }
    return false;
  }

  void scale() {
    constexpr size_t kVerticesPerTask = size_t{1} << 14;
    parallelFor(mesh_.vertices.size(), kVerticesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) mesh_.vertices[v] = scaled(mesh_.vertices[v]);
    });
    mesh_.origin = grid_.position(middle_);
  }
  glm::vec3 scaled(const glm::vec3& samples) const { return glm::vec3(grid_.spacing * glm::dvec3(samples)); }

  const Grid& grid_;
  glm::dvec3 middle_;  // Middle of the grid, in samples; vertices are relative to it.
  Progress& progress_;
  ContourCubes cubes_;
  ContourSheets sheets_;
  std::vector<Quadric> quadrics_;   // One per vertex.
  Mesh& mesh_;                      // In samples until `scale`.
  std::vector<uint8_t> isSuspect_;  // Per quad: whether its triangles may cross others.
};

}  // namespace

void dualContour(const Grid& grid, ContourRows cubes, const ContourCubes::SampleValue& value,
                 const AddPlanes& addPlanes, Progress& progress, Mesh& result) {
  Contour(grid, std::move(cubes), value, addPlanes, progress, result).run();
}

}  // namespace raymap
