#include "method/plate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace raymap {

FieldOptions withoutThickness(const FieldOptions& options, const Grid& grid) {
  FieldOptions plain = options;
  plain.sign = SignMode::None;
  plain.thickness = 0.0;
  plain.invert = false;
  if (plain.band > 0.0) plain.band += 0.5 * options.thickness / grid.spacing;
  return plain;
}

void thicken(const FieldOptions& options, int threads, Field& field) {
  field.clampDistance = options.band * field.grid.spacing;
  const double band = field.clampDistance > 0.0 ? field.clampDistance : INFINITY;
  const double half = 0.5 * options.thickness;
  withThreads(threads, [&] {
    parallelFor(field.distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double d = std::clamp(double(field.distance[i]) - half, -band, band);
        field.distance[i] = static_cast<float>(options.invert ? -d : d);
      }
    });
  });
}

}  // namespace raymap
