#include "isosurface/plane_fit.h"

#include <algorithm>
#include <cmath>

#include "isosurface/cube_cycles.h"

namespace raymap {

namespace {

// Weight of the pull towards the crossings' mean, as a share of the planes' total weight.
constexpr double kPull = 0.01;
// Added to the variance that a line is fitted over, which must not be 0.
constexpr double kLeastSpread = 1e-3;
// Lengths of the mean of unit normals that are 57 and 40 degrees apart.
constexpr double kEdgeLength = 0.88, kSmoothLength = 0.94;
// Distance outside the cube, in samples, at which a plane's weight reaches 0.
constexpr double kReach = 0.5;

/// Largest distance of a coordinate outside the cube, less its margin, and the coordinate's axis.
struct Excess {
  explicit Excess(const glm::dvec3& p) {
    for (int a = 0; a < 3; ++a)
      if (const double excess = std::max(kCubeMargin - p[a], p[a] - 1.0 + kCubeMargin); excess > amount)
        amount = excess, axis = a;
  }
  double amount = 0.0;
  int axis = 0;
};

/// Line fitted to weighted points.
class Line {
 public:
  void add(double x, double y, double weight) {
    weight_ += weight;
    x_ += weight * x;
    y_ += weight * y;
    xx_ += weight * x * x;
    xy_ += weight * x * y;
  }
  double slope() const {
    return (weight_ * xy_ - x_ * y_) / (weight_ * xx_ - x_ * x_ + kLeastSpread * weight_ * weight_);
  }
  double atZero() const { return (y_ - slope() * x_) / weight_; }

 private:
  double weight_ = 0.0, x_ = 0.0, y_ = 0.0, xx_ = 0.0, xy_ = 0.0;
};

}  // namespace

void PlaneFit::addPlane(const glm::dvec3& point, const glm::dvec3& normal, double weight) {
  const glm::dvec3 p = point - low_;
  weight *= 1.0 - Excess(p).amount / kReach;
  if (!(weight > 0.0)) return;
  if (planes_.empty()) planes_.reserve(3 * kCubeEdges);
  planes_.push_back({p, normal, weight});
  matrix_ += weight * glm::outerProduct(normal, normal);
  right_ += weight * glm::dot(normal, p) * normal;
  weight_ += weight;
}

glm::dvec3 PlaneFit::solve() const {
  const glm::dvec3 p = closest();
  return low_ + glm::clamp(p + offset(p), kCubeMargin, 1.0 - kCubeMargin);
}

glm::dvec3 PlaneFit::closest() const {
  const double pull = kPull * std::max(weight_, 1.0);
  glm::dmat3 matrix = matrix_ + glm::dmat3(pull);
  glm::dvec3 right = right_ + pull / count_ * sum_;
  glm::dvec3 p = glm::inverse(matrix) * right;
  // Fixes coordinates outside the cube at its side, the farthest first, and fits the others anew.
  for (int held = 0; held < 3; ++held) {
    const Excess excess(p);
    if (!(excess.amount > 0.0)) break;
    const int a = excess.axis;
    const double side = std::clamp(p[a], kCubeMargin, 1.0 - kCubeMargin);
    right -= matrix[a] * side;
    for (int b = 0; b < 3; ++b) matrix[a][b] = matrix[b][a] = a == b ? 1.0 : 0.0;
    right[a] = side;
    p = glm::inverse(matrix) * right;
  }
  return glm::clamp(p, kCubeMargin, 1.0 - kCubeMargin);
}

/// Returns the offset from the point closest to all planes to the vertex.
///
/// A tangent plane of a curved surface leaves the surface by half the curvature times the squared distance
/// from the point of contact. The closest point therefore lies outside a round solid. A line is fitted to the
/// planes' distances over these squares. Its slope gives the curvature, its value at 0 the distance of the
/// surface itself.
///
/// Flat faces lie inside a round solid if their vertices lie on it. On average they lie inside by a twelfth
/// of both curvatures times the faces' area. The vertices are moved outside by this amount. The area is that
/// of a cube's side, seen along the normal. At an edge of the surface the point stays on the edge.
glm::dvec3 PlaneFit::offset(const glm::dvec3& p) const {
  Line line;
  glm::dvec3 normal(0.0);
  for (const Plane& plane : planes_) {
    const glm::dvec3 way = p - plane.point;
    const double distance = glm::dot(plane.normal, way);
    line.add(glm::dot(way, way) - distance * distance, distance, plane.weight);
    normal += plane.weight / weight_ * plane.normal;
  }
  const double length = glm::length(normal),
               smooth = std::min((length - kEdgeLength) / (kSmoothLength - kEdgeLength), 1.0);
  if (!(smooth > 0.0)) return glm::dvec3(0.0);
  normal /= length;
  const double curvatures = -4.0 * line.slope();
  const double area = 1.0 / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  return smooth * (curvatures * area / 12.0 - line.atZero()) * normal;
}

Quadric PlaneFit::quadric() const {
  const glm::mat3 m(matrix_ / std::max(weight_, 1e-9));
  return {m[0][0], m[1][1], m[2][2], m[0][1], m[1][2], m[2][0]};
}

}  // namespace raymap
