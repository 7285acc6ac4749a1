// The Hausdorff distance of two surfaces: parts of faces are halved until none can hold a point that is
// farther than the farthest one found by more than the tolerance.

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/closest_point.h"
#include "cpu/points/point_query.h"
#include "cpu/points/surface_pairs.h"
#include "cpu/points/triangle_pair.h"
#include "mesh/triangle.h"
#include "method/pose.h"

namespace raymap::cpu {

namespace {

/// Most parts that are halved together, and most that wait. Further ones would take too much memory: the
/// search then ends with the bound that it has.
constexpr size_t kPartsAtOnce = size_t{1} << 14, kMostHeldParts = size_t{1} << 24;

/// Part of a face, and what the distances of its points do not exceed.
struct Part {
  double most;
  Corners corners;
  uint32_t face;

  glm::dvec3 centre() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
  /// Returns the number of the corner opposite the longest side.
  size_t tip() const {
    const auto side = [&](size_t i) { return glm::distance(corners[(i + 1) % 3], corners[(i + 2) % 3]); };
    return side(0) >= side(1) && side(0) >= side(2) ? 0 : side(1) >= side(2) ? 1 : 2;
  }
};

bool isLess(const Part& a, const Part& b) {
  return a.most < b.most;
}

/// Searches the points of one mesh for the one that is farthest from a surface, in the surface's coordinates.
class FarthestSearch {
 public:
  FarthestSearch(const PreparedSurface& to, double tolerance, double known, Progress& progress)
      : to_(to), tolerance_(tolerance), progress_(progress) {
    found_.distance = found_.bound = known;
  }

  /// Returns the farthest point if it is farther than what is known, and else only a bound.
  SurfacePair search(const std::vector<glm::dvec3>& vertices, std::span<const glm::uvec3> faces) {
    measureFaces(vertices, faces);
    while (!parts_.empty() && parts_.front().most > found_.distance + tolerance_) {
      progress_.poll();
      if (parts_.size() > kMostHeldParts) break;
      halve();
    }
    if (!parts_.empty()) found_.bound = std::max(found_.bound, parts_.front().most);
    found_.bound = std::max(found_.bound, found_.distance);
    return found_;
  }

 private:
  /// Measures the corners of the faces. Each point of a face is within its longest side / sqrt(3) of one.
  void measureFaces(const std::vector<glm::dvec3>& vertices, std::span<const glm::uvec3> faces) {
    std::vector<uint32_t> faceOf(vertices.size(), kNoTriangle), place(vertices.size());
    for (uint32_t f = 0; f < faces.size(); ++f)
      for (int c = 0; c < 3; ++c) faceOf[faces[f][c]] = f;
    std::vector<uint32_t> facesOfPoints;
    for (size_t v = 0; v < vertices.size(); ++v) {
      if (faceOf[v] == kNoTriangle) continue;
      place[v] = uint32_t(points_.size());
      points_.push_back(vertices[v]);
      facesOfPoints.push_back(faceOf[v]);
    }
    measure([&](size_t i) { return facesOfPoints[i]; });
    for (uint32_t f = 0; f < faces.size(); ++f) {
      const glm::uvec3& face = faces[f];
      const Corners corners{vertices[face.x], vertices[face.y], vertices[face.z]};
      double most = 0.0;
      for (int c = 0; c < 3; ++c) most = std::max(most, query_.distance[place[face[c]]]);
      keep({most + longestSide(corners[0], corners[1], corners[2]) / std::sqrt(3.0), corners, f});
    }
  }

  /// Halves the parts that may hold the farthest points.
  void halve() {
    std::vector<Part> halves;
    std::vector<glm::dvec3> middles;
    for (size_t k = 0; k < kPartsAtOnce && !parts_.empty(); ++k) {
      if (parts_.front().most <= found_.distance + tolerance_) break;
      std::ranges::pop_heap(parts_, isLess);
      const Part part = parts_.back();
      parts_.pop_back();
      const size_t tip = part.tip(), next = (tip + 1) % 3, last = (tip + 2) % 3;
      middles.push_back(0.5 * (part.corners[next] + part.corners[last]));
      halves.resize(halves.size() + 2, part);
      halves.end()[-2].corners[last] = halves.end()[-1].corners[next] = middles.back();
    }
    points_.clear();
    for (const Part& half : halves) points_.push_back(half.centre());
    points_.insert(points_.end(), middles.begin(), middles.end());
    const size_t count = halves.size();
    measure([&](size_t i) { return halves[i < count ? i : 2 * (i - count)].face; });
    parallelFor(count, 256, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        halves[i].most = std::min(halves[i].most, boundOf(halves[i], query_.distance[i], query_.triangle[i]));
    });
    for (const Part& half : halves) keep(half);
  }

  /// Measures the points. `faceOf` returns the face on which one of them lies.
  template <class FaceOf>
  void measure(FaceOf&& faceOf) {
    queryUnsigned(to_, points_, {.triangle = true}, silent_, query_);
    for (size_t i = 0; i < points_.size(); ++i)
      if (query_.distance[i] > found_.distance)
        found_ = {query_.distance[i], found_.bound, points_[i], {}, faceOf(i), query_.triangle[i]};
  }

  /// Keeps a part that may hold a farther point.
  void keep(const Part& part) {
    if (part.most > found_.distance + tolerance_) {
      parts_.push_back(part);
      std::ranges::push_heap(parts_, isLess);
    } else {
      found_.bound = std::max(found_.bound, part.most);
    }
  }

  /// Returns what distances in a part do not exceed: the distance of its centre and the way to it, or the
  /// largest distance of its corners from one triangle, as a triangle is convex.
  double boundOf(const Part& part, double atCentre, uint32_t triangle) const {
    const PackedMesh& mesh = to_.mesh;
    const auto [a, b, c] = mesh.corners(mesh.triangles[triangle]);
    double way = 0.0, atCorners = 0.0;
    for (const glm::dvec3& corner : part.corners) {
      const glm::dvec3 p = corner - mesh.origin;
      way = std::max(way, glm::distance(corner, part.centre()));
      atCorners = std::max(atCorners, glm::distance(p, closestPoint(p, a, b, c).position));
    }
    return std::min(atCentre + way, atCorners);
  }

  const PreparedSurface& to_;
  double tolerance_;
  Progress& progress_;
  Progress silent_;
  SurfacePair found_;
  std::vector<Part> parts_;  // A heap: the first may hold the farthest point.
  std::vector<glm::dvec3> points_;
  QueryResult query_;
};

/// Searches the points of `from` for one that is farther from `to` than `found`. `move` takes the coordinates
/// of the one to those of the other.
template <class Move>
SurfacePair searchFrom(const PreparedSurface& from, const PreparedSurface& to, double tolerance, double known,
                       Progress& progress, Move&& move) {
  std::vector<glm::dvec3> vertices;
  vertices.reserve(from.mesh.vertices.size());
  for (uint32_t v = 0; v < from.mesh.vertices.size(); ++v) vertices.push_back(move(from.mesh.position(v)));
  SurfacePair found = FarthestSearch(to, tolerance, known, progress).search(vertices, from.mesh.triangles);
  if (found.otherTriangle == kNoTriangle) return found;
  const auto [a, b, c] = to.mesh.corners(to.mesh.triangles[found.otherTriangle]);
  found.otherPoint = closestPoint(found.point - to.mesh.origin, a, b, c).position + to.mesh.origin;
  return found;
}

}  // namespace

SurfacePair farthestPoint(const PreparedSurface& a, const PreparedSurface& b, const HausdorffOptions& options,
                          Progress& progress) {
  const glm::dmat4& pose = options.pose;
  const double tolerance = options.tolerance > 0.0 ? options.tolerance : 1e-4 * glm::length(a.bounds.size());
  const double scale = scaleOf(pose);
  SurfacePair found = searchFrom(a, b, tolerance / scale, -1.0, progress,
                                 [&](const glm::dvec3& p) { return movedBack(pose, p); });
  found.distance *= scale;
  found.bound *= scale;
  found.point = moved(pose, found.point);
  found.otherPoint = moved(pose, found.otherPoint);
  if (!options.bothWays) return found;
  const SurfacePair back = searchFrom(b, a, tolerance, found.distance, progress,
                                      [&](const glm::dvec3& p) { return moved(pose, p); });
  found.bound = std::max(found.bound, back.bound);
  if (back.otherTriangle != kNoTriangle)
    found = {back.distance, found.bound, back.otherPoint, back.point, back.otherTriangle, back.triangle};
  return found;
}

}  // namespace raymap::cpu
