#include "predicates/turn.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace raymap {

namespace {

/// A sum of doubles without rounding: parts that do not overlap, the smallest first (Shewchuk 1997).
class ExactSum {
 public:
  void addProduct(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }

  int sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] > 0.0 ? 1 : -1; }

 private:
  void add(double value) {
    size_t kept = 0;
    for (size_t i = 0; i < count_; ++i) {
      const double sum = value + parts_[i];
      const double ofPart = sum - value;
      const double lost = (value - (sum - ofPart)) + (parts_[i] - ofPart);
      if (lost != 0.0) parts_[kept++] = lost;
      value = sum;
    }
    if (value != 0.0) parts_[kept++] = value;
    count_ = kept;
  }

  std::array<double, 12> parts_{};
  size_t count_ = 0;
};

}  // namespace

int turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  constexpr double kRounding = 3.33067e-16;  // (3 + 16 e) e, where e is 2^-53.
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double area = left - right;
  if (std::abs(area) > kRounding * (std::abs(left) + std::abs(right))) return area > 0.0 ? 1 : -1;
  ExactSum sum;
  sum.addProduct(a.x, b.y);
  sum.addProduct(-a.x, c.y);
  sum.addProduct(-c.x, b.y);
  sum.addProduct(-a.y, b.x);
  sum.addProduct(a.y, c.x);
  sum.addProduct(c.y, b.x);
  return sum.sign();
}

}  // namespace raymap
