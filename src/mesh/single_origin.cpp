#include "mesh/single_origin.h"

namespace raymap {

double roundedMiddle(double low, double high) {
  constexpr int kBits = 16;
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const double step = half > 0.0 ? std::ldexp(1.0, std::ilogb(half) - kBits) : 0.0;
  // Adding 0 turns -0 into 0.
  return step > 0.0 ? std::round(middle / step) * step + 0.0 : middle;
}

}  // namespace raymap
