// Ours: the local thickness of a mesh. See docs/dev/decisions/local_thickness.md.
//
// A ray leaves the point inwards and ends where it leaves the solid. The plane of the face there and the
// point define the ball: it is the largest that touches the point without passing that plane. The ball
// counts if the solid is free of faces around its middle.

#include "cpu/points/local_thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "base/parallel.h"
#include "cpu/points/face_crossings.h"
#include "cpu/points/near_surface.h"
#include "cpu/points/point_cells.h"
#include "cpu/points/point_winding.h"
#include "cpu/points/ray_hits.h"
#include "cpu/points/segment_crossings.h"
#include "mesh/triangle.h"

namespace raymap::cpu {

namespace {

/// Points are taken to either side of a face by this share of the mesh's diagonal to ask for the winding
/// number. It is far above the rounding errors of the positions, and below all thickness that matters.
constexpr double kBeside = 1e-5;

/// Sides are opposite if the angle between one normal and the reverse of the other is at most 40 degrees.
const double kLeastCosine = std::cos(glm::radians(40.0));

/// Share of the ball's radius around its middle that must be free of faces. Rough surfaces reach into the
/// rest, and faces of a convex body that are not opposite into this share.
constexpr double kFree = 0.75;

/// Walls that meet at less than this angle do not run out to an edge.
const double kLeastEdgeSine = std::sin(glm::radians(5.0));

/// Rays are searched in parts, each this many times as long as the one before. The first is as many cells
/// long.
constexpr double kLonger = 4.0, kFirstReach = 0.5;

constexpr size_t kPointsPerTask = 1024;

class LocalThickness {
 public:
  LocalThickness(const PreparedSurface& surface, double most)
      : surface_(surface), slack_(slackOf(surface.signTree(), surface.grid.dims)) {
    const double diagonal = glm::length(bounds(surface.mesh).size());
    beside_ = kBeside * diagonal;
    reach_ = std::min(diagonal, most);
    most_ = most;
  }

  double beside() const { return beside_; }
  /// Returns the direction from a face into the solid between two winding numbers, 0 if it has none.
  glm::dvec3 inwards(const glm::dvec3& normal, double front, double back) const {
    if (isInside(front) == isInside(back)) return glm::dvec3(0.0);
    return isInside(front) ? normal : -normal;
  }
  /// Returns the length of the first part of a ray.
  double firstReach() const { return std::min(kFirstReach * surface_.grid.spacing, reach()); }

  /// Returns the unit normal of a face, or 0 if the face is so narrow that rounding turns it or that a step
  /// to its side passes its neighbours.
  glm::dvec3 normal(uint32_t triangle) const {
    const auto [a, b, c] = surface_.mesh.corners(surface_.mesh.triangles[triangle]);
    const glm::dvec3 n = doubleAreaNormal(a, b, c);
    const double length = glm::length(n);
    return length > 2.0 * beside_ * longestSide(a, b, c) ? n / length : glm::dvec3(0.0);
  }

  /// Measures a point between two winding numbers, in front of its face and behind it. `near` are the faces
  /// along the first part of its ray.
  Thickness measure(const FacePoint& point, double front, double back, std::span<const uint32_t> near) {
    const glm::dvec3 inward = inwards(normal(point.triangle), front, back);
    if (inward == glm::dvec3(0.0))
      return isInside(front) ? Thickness{Part::Buried, INFINITY, glm::vec3(0.0f)}
                             : Thickness{Part::Sheet, 0.0f, glm::vec3(0.0f)};
    const glm::dvec3 p = point.position - surface_.mesh.origin;
    const RayHit* exit = findExit(p, inward, isInside(front) ? front : back, near);
    Thickness result{Part::Solid, INFINITY, glm::vec3(inward)};
    if (!exit) return result;
    const double cosine = glm::dot(exit->normal, inward);
    const double diameter = 2.0 * exit->distance * cosine / (1.0 + cosine);
    if (cosine >= kLeastCosine && diameter > most_) return result;
    result.part = Part::Corner;
    if (cosine < kLeastCosine) return result;
    result.diameter = static_cast<float>(diameter);
    if (isFree(p + 0.5 * diameter * inward, kFree * 0.5 * diameter))
      result.part = runsOut(p, inward, *exit) ? Part::Edge : Part::Wall;
    return result;
  }

 private:
  bool isInside(double winding) const { return std::abs(winding) > surface_.threshold; }

  glm::vec3 cellsOf(const glm::dvec3& p) const { return toCells(surface_.grid, p + surface_.mesh.origin); }

  bool isFree(const glm::dvec3& centre, double radius) const {
    return !isNearSurface(surface_.tree, cellsOf(centre), static_cast<float>(radius / surface_.grid.spacing));
  }

  /// Returns how far a ray is searched. A ball of diameter `reach_` touches planes that lie this far along
  /// it.
  double reach() const { return reach_ * 0.5 * (1.0 + 1.0 / kLeastCosine) + beside_; }

  /// Returns where a ray that begins inside leaves the solid, or null. Most rays are short.
  const RayHit* findExit(const glm::dvec3& p, const glm::dvec3& direction, double winding,
                         std::span<const uint32_t> near) {
    const RayHit* exit = exitAmong(near, p, direction, winding, firstReach());
    for (double length = firstReach(); !exit && length < reach();) {
      length = std::min(length * kLonger, reach());
      findTrianglesAlong(surface_.signTree(), cellsOf(p), cellsOf(p + (length + beside_) * direction), slack_,
                         faces_);
      for (uint32_t& t : faces_) t = surface_.signTree().triangleId(t);
      exit = exitAmong(faces_, p, direction, winding, length);
    }
    return exit;
  }

  const RayHit* exitAmong(std::span<const uint32_t> faces, const glm::dvec3& p, const glm::dvec3& direction,
                          double winding, double length) {
    findRayHits(surface_.mesh, surface_.turns, faces, p, direction, hits_);
    for (size_t begin = 0; begin < hits_.size() && hits_[begin].distance <= length;) {
      if (hits_[begin].distance <= beside_) {
        ++begin;
        continue;
      }
      size_t end = begin;
      // Solids that touch are one.
      for (; end < hits_.size() && hits_[end].distance <= hits_[begin].distance + beside_; ++end)
        winding += hits_[end].change;
      if (!isInside(winding)) return &hits_[begin];
      begin = end;
    }
    return nullptr;
  }

  /// Returns whether two sides meet in an edge of the mesh. The exit's plane meets the tangent plane of the
  /// point there, and beyond it nothing follows.
  bool runsOut(const glm::dvec3& p, const glm::dvec3& inward, const RayHit& exit) const {
    const double cosine = glm::dot(exit.normal, inward);
    const glm::dvec3 across = exit.normal - cosine * inward;
    const double sine = glm::length(across);
    if (sine < kLeastEdgeSine) return false;
    const glm::dvec3 way = across / sine, edge = p + way * (exit.distance * cosine / sine);
    constexpr double kNear = 0.25, kBeyond = 1.0, kEmpty = 0.5;  // Shares of the thickness.
    return !isFree(edge, kNear * exit.distance) &&
           isFree(edge + kBeyond * exit.distance * way, kEmpty * exit.distance);
  }

  const PreparedSurface& surface_;
  float slack_;
  double beside_, reach_, most_;
  std::vector<uint32_t> faces_;
  std::vector<RayHit> hits_;
};

/// Winding numbers beside points, in front of the faces and behind them, well enough to tell sides, and the
/// faces near by.
class WindingBeside {
 public:
  explicit WindingBeside(const PreparedSurface& surface)
      : surface_(surface), winding_(surface.windingSource()) {}

  void compute(const LocalThickness& local, std::span<const FacePoint> points) {
    points_ = points;
    beside_ = local.beside();
    normals_.clear();
    numbers_.assign(points.size(), {NAN, NAN});
    for (const FacePoint& point : points) normals_.push_back(local.normal(point.triangle));
    clear();
    for (size_t i = 0; i < points.size(); ++i)
      if (hasSides(i)) add(i, 0);
    ask();
    findAlong([&](size_t i) { return std::pair(placeOf(i, 0), placeOf(i, 1)); });
    clear();
    for (size_t i = 0; i < points.size(); ++i) {
      if (!hasSides(i)) continue;
      numbers_[i][1] = numbers_[i][0] + changeThrough(i);
      const double gap = std::abs(std::abs(numbers_[i][1]) - surface_.threshold);
      if (!(gap > kDoubt) || isNearEdge(i)) add(i, 1);
    }
    ask();
    const double length = local.firstReach() + beside_;
    findAlong([&](size_t i) {
      const glm::dvec3& p = points_[i].position;
      return std::pair(p, p + length * local.inwards(normals_[i], front(i), back(i)));
    });
  }

  /// Returns whether the face of a point has a normal. Others have no numbers.
  bool hasSides(size_t i) const { return normals_[i] != glm::dvec3(0.0); }
  double front(size_t i) const { return numbers_[i][0]; }
  double back(size_t i) const { return numbers_[i][1]; }
  /// Returns the faces along the first part of a point's ray, if there is one.
  std::span<const uint32_t> near(size_t i) const {
    const size_t end = i + 1 < places_.size() ? places_[i + 1] : from_.size();
    return places_[i] < end ? near_[places_[i]] : std::span<const uint32_t>();
  }

 private:
  static constexpr double kDoubt = 0.2;  ///< Error of a number of which only the side matters.

  /// Returns the position beside a point: in front of its face, or with `side` 1 behind it.
  glm::dvec3 placeOf(size_t i, int side) const {
    return points_[i].position + (side == 0 ? beside_ : -beside_) * normals_[i];
  }

  void clear() { cells_.clear(), exact_.clear(), wanted_.clear(); }

  /// Asks for the number of a point on one side.
  void add(size_t i, int side) {
    const glm::dvec3 place = placeOf(i, side);
    cells_.push_back(toCells(surface_.grid, place));
    exact_.push_back(place - surface_.mesh.origin);
    wanted_.push_back(&numbers_[i][size_t(side)]);
  }

  void ask() {
    distances_.assign(cells_.size(), float(beside_ / surface_.grid.spacing));
    asked_.resize(cells_.size());
    winding_.compute({cells_, exact_, distances_}, asked_);
    for (size_t i = 0; i < asked_.size(); ++i) *wanted_[i] = asked_[i];
  }

  /// Finds the faces along `segmentOf(i)` for each point, unless it has no length.
  template <class SegmentOf>
  void findAlong(SegmentOf&& segmentOf) {
    from_.clear(), to_.clear();
    places_.assign(points_.size(), 0);
    for (size_t i = 0; i < points_.size(); ++i) {
      const std::pair<glm::dvec3, glm::dvec3> segment = segmentOf(i);
      places_[i] = from_.size();
      if (segment.first == segment.second) continue;
      from_.push_back(toCells(surface_.grid, segment.first));
      to_.push_back(toCells(surface_.grid, segment.second));
    }
    const SurfaceTree& tree = surface_.signTree();
    findTrianglesAlong(tree, from_, to_, slackOf(tree, surface_.grid.dims), near_);
    for (uint32_t& face : near_.triangles) face = tree.triangleId(face);
  }

  /// Returns by how much the faces at a point change the number, or NaN if rounding could tell.
  double changeThrough(size_t i) const {
    const glm::dvec3& origin = surface_.mesh.origin;
    const int32_t change = countFaceCrossings(surface_.mesh, surface_.turns, near_[places_[i]],
                                              placeOf(i, 0) - origin, placeOf(i, 1) - origin);
    return change == kUnsure ? NAN : double(change);
  }

  /// Returns whether an edge of the face is so near that it would change the number if it is a rim.
  bool isNearEdge(size_t i) const {
    if (surface_.lattice.isWhole()) return false;
    constexpr double kNear = 10.0;  // A straight rim changes it by 1 / 10 pi at such a distance.
    const auto corners = surface_.mesh.corners(surface_.mesh.triangles[points_[i].triangle]);
    const glm::dvec3 p = points_[i].position - surface_.mesh.origin;
    for (size_t k = 0; k < 3; ++k) {
      const glm::dvec3 along = corners[(k + 1) % 3] - corners[k];
      if (glm::length(glm::cross(along, p - corners[k])) < kNear * beside_ * glm::length(along)) return true;
    }
    return false;
  }

  const PreparedSurface& surface_;
  PointWinding winding_;
  std::span<const FacePoint> points_;
  double beside_ = 0.0;
  std::vector<glm::dvec3> normals_;  // Of the points' faces, 0 where these have no sides.
  std::vector<std::array<double, 2>> numbers_;
  std::vector<glm::vec3> from_, to_;  // Segments that are searched,
  std::vector<size_t> places_;        // the place of each point's among them,
  TrianglesAlong near_;               // and the faces along them.
  // Positions that are asked for, and where their numbers go.
  std::vector<glm::vec3> cells_;
  std::vector<glm::dvec3> exact_;
  std::vector<float> distances_;
  std::vector<double> asked_;
  std::vector<double*> wanted_;
};

}  // namespace

void measureThickness(const PreparedSurface& surface, std::span<const FacePoint> points, double most,
                      Progress& progress, std::span<Thickness> thickness) {
  const size_t tasks = (points.size() + kPointsPerTask - 1) / kPointsPerTask;
  WorkMeter meter(progress, 0.0, 1.0, double(points.size()) + 1.0);
  parallelWorkers(tasks, [&](const auto& next) {
    LocalThickness local(surface, most);
    WindingBeside winding(surface);
    for (size_t task = next(); task < tasks; task = next()) {
      const size_t first = task * kPointsPerTask;
      const std::span<const FacePoint> some =
          points.subspan(first, std::min(kPointsPerTask, points.size() - first));
      winding.compute(local, some);
      for (size_t i = 0; i < some.size(); ++i)
        thickness[first + i] =
            winding.hasSides(i) ? local.measure(some[i], winding.front(i), winding.back(i), winding.near(i))
                                : Thickness{Part::Corner, INFINITY};
      meter.add(some.size());
    }
  });
}

}  // namespace raymap::cpu
