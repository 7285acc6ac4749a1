#include "simplify/given_surface.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "cpu/points/closest_point.h"
#include "mesh/face_points.h"
#include "simplify/face_shape.h"

namespace raymap {

namespace {

constexpr size_t kVerticesPerTask = size_t{1} << 14;
constexpr size_t kMostUnsure = 24;  // Faces around a vertex. If more are unsure, all are measured.

enum class Nearness : uint8_t { Near, Far, Unsure };

/// Tells whether a point is within the square root of `limit` of a face, where rounding cannot matter.
Nearness guessNearness(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                       double limit) {
  // Errors stay below the margin for points and faces of this size, and for faces with this sine at a corner.
  constexpr double kMargin = 1e-6, kMostSquare = 1e12, kLeastSquaredSine = 1e-6;
  const glm::dvec3 ab = b - a, ac = c - a, normal = glm::cross(ab, ac), toPoint = p - a;
  const double area2 = squareOf(normal), height = glm::dot(normal, toPoint);
  if (squareOf(a) + squareOf(p) > kMostSquare * limit ||
      area2 <= kLeastSquaredSine * squareOf(ab) * squareOf(ac))
    return Nearness::Unsure;
  const double far = limit * (1.0 + kMargin) * area2;
  if (height * height > far) return Nearness::Far;
  bool isBeside = true;
  const auto isBeyond = [&](const glm::dvec3& edge, const glm::dvec3& fromEdge) {
    const double inwards = glm::dot(glm::cross(normal, edge), fromEdge);
    if (inwards >= 0.0) return false;
    isBeside = false;
    return inwards * inwards > far * squareOf(edge);
  };
  if (isBeyond(ab, toPoint) || isBeyond(c - b, p - b) || isBeyond(-ac, toPoint)) return Nearness::Far;
  return isBeside && height * height <= limit * (1.0 - kMargin) * area2 ? Nearness::Near : Nearness::Unsure;
}

}  // namespace

GivenSurface::GivenSurface(const PackedMesh& mesh, double limit) : mesh_(mesh), limit_(limit) {
  listFaces();
  listNeighbours();
}

void GivenSurface::listFaces() {
  starts_.resize(mesh_.vertices.size() + 2);
  faces_.resize(3 * mesh_.triangles.size());
  for (const glm::uvec3& t : mesh_.triangles)
    for (int k = 0; k < 3; ++k) ++starts_[t[k] + 2];
  for (size_t v = 2; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) faces_[starts_[mesh_.triangles[f][k] + 1]++] = f;
}

void GivenSurface::listNeighbours() {
  neighbours_.resize(faces_.size());
  parallelFor(mesh_.vertices.size(), kVerticesPerTask, [&](size_t begin, size_t end) {
    for (auto v = uint32_t(begin); v < end; ++v) {
      auto next = neighbours_.begin() + starts_[v];
      const auto first = next;
      for (const uint32_t f : facesOf(v))
        for (int k = 0; k < 3; ++k)
          if (const uint32_t other = mesh_.triangles[f][k];
              other != v && std::find(first, next, other) == next)
            *next++ = other;
    }
  });
}

bool GivenSurface::isNearEdge(uint32_t start, uint32_t end, int parts) const {
  NearFace near{start};
  bool isNear = true;
  forEachEdgePoint(at(start), at(end), parts, [&](const glm::dvec3& p) {
    if (!isNear) return;
    if (const uint32_t vertex = walkTo(p, near.vertex); vertex != near.vertex) near = {vertex};
    isNear = isNearFacesOf(p, near) || std::ranges::any_of(neighboursOf(near.vertex), [&](uint32_t v) {
               NearFace other{v};
               return isNearFacesOf(p, other);
             });
  });
  return isNear;
}

/// Goes from a given vertex to its neighbour closest to a point, and on while there is a closer one.
uint32_t GivenSurface::walkTo(const glm::dvec3& p, uint32_t vertex) const {
  uint32_t closest = vertex;
  double least = squareOf(at(vertex) - p);
  do {
    vertex = closest;
    for (const uint32_t v : neighboursOf(vertex))
      if (const double squared = squareOf(at(v) - p); squared < least) least = squared, closest = v;
  } while (closest != vertex);
  return closest;
}

/// Returns whether a point is within the tolerance of the given faces around a vertex. Begins at the face
/// that was near the last point.
bool GivenSurface::isNearFacesOf(const glm::dvec3& p, NearFace& near) const {
  std::array<uint32_t, kMostUnsure> unsure;
  const std::span<const uint32_t> faces = facesOf(near.vertex);
  size_t count = 0, k = near.place;
  for (size_t tried = 0; tried < faces.size(); ++tried, k = k + 1 < faces.size() ? k + 1 : 0) {
    const glm::uvec3 face = mesh_.triangles[faces[k]];
    const Nearness nearness = guessNearness(p, at(face.x), at(face.y), at(face.z), limit_);
    if (nearness == Nearness::Near) {
      near.place = uint32_t(k);
      return true;
    }
    if (nearness == Nearness::Far) continue;
    if (count == unsure.size()) return hasFaceWithin(faces, p);
    unsure[count++] = faces[k];
  }
  return hasFaceWithin({unsure.data(), count}, p);
}

/// Returns whether a point is within the tolerance of one of these given faces.
bool GivenSurface::hasFaceWithin(std::span<const uint32_t> faces, const glm::dvec3& p) const {
  return std::ranges::any_of(faces, [&](uint32_t f) {
    const glm::uvec3 face = mesh_.triangles[f];
    const cpu::TrianglePoint closest = cpu::closestPoint(p, at(face.x), at(face.y), at(face.z));
    return squareOf(closest.position - p) <= limit_;
  });
}

}  // namespace raymap
