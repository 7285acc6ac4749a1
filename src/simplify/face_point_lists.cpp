#include "simplify/face_point_lists.h"

#include <algorithm>
#include <cmath>

#include "cpu/points/close_distances.h"
#include "mesh/face_points.h"
#include "simplify/face_shape.h"

namespace raymap {

namespace {

// An edge is sharp if the other diagonal of its two faces is farther away than this share of the tolerance.
constexpr double kSharp = 0.25;
// A face with a longer side than so many steps has points besides its corners, on its edges too. Corners
// alone cover the area of the others, of which the decimator wants a point for each two squares of a step.
constexpr double kLarge = 1.25;
constexpr double kMostOnFaces = 1e6, kMostOnFace = 32.0;

}  // namespace

FaceSums sumFaces(const PackedMesh& mesh) {
  FaceSums sums;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x), b = mesh.position(t.y), c = mesh.position(t.z);
    sums.area += triangleArea(a, b, c);
    sums.sides += glm::distance(a, b) + glm::distance(b, c) + glm::distance(c, a);
  }
  return sums;
}

double boundedStep(const PackedMesh& mesh, double step) {
  const FaceSums sums = sumFaces(mesh);
  // A step s takes area / s² + sides / s points.
  const double most = kMostOnFaces + kMostOnFace * double(mesh.triangles.size());
  const double half = 0.5 * sums.sides / most;
  return std::max(step, half + std::sqrt(half * half + sums.area / most));
}

FacePointLists::FacePointLists(const PackedMesh& given, const CollapsibleMesh& mesh, double step,
                               double tolerance)
    : given_(given),
      points_(given.vertices.begin(), given.vertices.end()),
      first_(given.triangles.size(), kNoIndex),
      next_(given.vertices.size(), kNoIndex),
      face_(given.vertices.size(), kNoIndex) {
  const auto at = [&](uint32_t vertex) { return glm::dvec3(given.vertices[vertex]); };
  const double mostOff = kSharp * kSharp * (tolerance * tolerance);
  const double large = kLarge * step;
  for (uint32_t h = 0; h < 3 * mesh.faceCount(); ++h) {
    const uint32_t t = mesh.twin(h);
    if (t < h) continue;
    const glm::dvec3 a = at(mesh.from(h)), b = at(mesh.to(h)), c = at(mesh.opposite(h));
    const glm::dvec3 across = at(mesh.opposite(t)) - c, middle = 0.5 * (a + b) - c;
    const double along = std::clamp(glm::dot(middle, across) / std::max(squareOf(across), 1e-300), 0.0, 1.0);
    const double length = glm::distance(a, b);
    if (squareOf(middle - along * across) < mostOff && length <= large) continue;
    const int parts = std::max(static_cast<int>(std::min(length / step, 1e6)), 1);
    forEachEdgePoint(a, b, parts, [&](const glm::dvec3& p) { add(h / 3, glm::vec3(p)); });
  }
  for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
    const glm::uvec3 face = mesh.face(f);
    const glm::dvec3 a = at(face.x), b = at(face.y), c = at(face.z);
    if (longestSide(a, b, c) > large)
      forEachFacePoint(a, b, c, step, [&](const glm::dvec3& p) { add(f, glm::vec3(p)); });
  }
}

void FacePointLists::add(uint32_t face, const glm::vec3& point) {
  points_.push_back(point);
  next_.push_back(kNoIndex);
  face_.push_back(kNoIndex);
  put(uint32_t(points_.size() - 1), face);
}

void FacePointLists::put(uint32_t point, uint32_t face) {
  next_[point] = first_[face];
  first_[face] = point;
  face_[point] = face;
}

void FacePointLists::take(uint32_t point) {
  uint32_t* link = &first_[face_[point]];
  while (*link != point) link = &next_[*link];
  *link = next_[point];
  face_[point] = kNoIndex;
}

void FacePointLists::spread(std::span<const uint32_t> faces, const CollapsibleMesh& mesh) {
  std::vector<uint32_t> numbers;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (const uint32_t f : faces) {
    triangles.push_back(mesh.face(f));
    allOf(f, [&](uint32_t point) {
      numbers.push_back(point);
      positions.push_back(points_[point]);
      return true;
    });
    clear(f);
  }
  if (numbers.empty()) return;
  const cpu::CloseDistances search({given_.vertices, triangles, glm::dvec3(0.0)}, INFINITY);
  const QueryResult found = search.measure(positions);
  for (size_t i = 0; i < numbers.size(); ++i) put(numbers[i], faces[found.triangle[i]]);
}

}  // namespace raymap
