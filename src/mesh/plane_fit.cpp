#include "plane_fit.h"

#include <algorithm>

namespace raymap {

namespace {

constexpr double kPull = 0.01;  // Towards the crossings' mean, beside planes of weight 1 each.
constexpr double kReach = 0.5;  // A plane known from a point that far outside of the cube counts for nothing.
constexpr double kMargin = 1e-3;  // Share of a cube kept to its sides.

/// By how much the worst coordinate lies outside of the cube, and which it is.
struct Excess {
  explicit Excess(const glm::dvec3& p) {
    for (int a = 0; a < 3; ++a)
      if (const double excess = std::max(kMargin - p[a], p[a] - 1.0 + kMargin); excess > amount)
        amount = excess, axis = a;
  }
  double amount = 0.0;
  int axis = 0;
};

}  // namespace

void PlaneFit::addPlane(const glm::dvec3& point, const glm::dvec3& normal, double weight) {
  const glm::dvec3 p = point - low_;
  weight *= 1.0 - Excess(p).amount / kReach;
  if (!(weight > 0.0)) return;
  planes_ += weight * glm::outerProduct(normal, normal);
  offsets_ += weight * glm::dot(normal, p) * normal;
  weight_ += weight;
}

glm::dvec3 PlaneFit::solve() const {
  const double pull = kPull * std::max(weight_, 1.0);
  glm::dmat3 matrix = planes_ + glm::dmat3(pull);
  glm::dvec3 right = offsets_ + pull / count_ * sum_;
  glm::dvec3 p = glm::inverse(matrix) * right;
  // What lies outside is held at the cube's side, the worst first, and the rest fitted anew.
  for (int held = 0; held < 3; ++held) {
    const Excess excess(p);
    if (!(excess.amount > 0.0)) break;
    const int a = excess.axis;
    const double side = std::clamp(p[a], kMargin, 1.0 - kMargin);
    right -= matrix[a] * side;
    for (int b = 0; b < 3; ++b) matrix[a][b] = matrix[b][a] = a == b ? 1.0 : 0.0;
    right[a] = side;
    p = glm::inverse(matrix) * right;
  }
  return low_ + glm::clamp(p, kMargin, 1.0 - kMargin);
}

Quadric PlaneFit::quadric() const {
  const glm::mat3 m(planes_ / std::max(weight_, 1e-9));
  return {m[0][0], m[1][1], m[2][2], m[0][1], m[1][2], m[2][0]};
}

}  // namespace raymap
