#include "method/far_field.h"

#include <algorithm>
#include <cfloat>

namespace raymap {

namespace {

template <class T>
void fill(Buffer<T>& array, size_t size, T value) {
  array.resizeUninitialized(size);
  std::ranges::fill(array, value);
}

}  // namespace

float farDistance(const FieldOptions& options, double spacing) {
  const float far = options.band > 0.0 ? float(options.band) * float(spacing) : FLT_MAX;
  const bool hasSides = options.sign != SignMode::None || options.thickness > 0.0;
  return hasSides && options.invert ? -far : far;
}

void fillFar(const Grid& grid, const FieldOptions& options, Field& field) {
  const size_t count = grid.sampleCount();
  field.grid = grid;
  field.clampDistance = options.band * grid.spacing;
  field.surfaceBounds = {};
  fill(field.distance, count, farDistance(options, grid.spacing));
  fill(field.triangle, options.triangle ? count : 0, kNoTriangle);
  fill(field.winding, options.winding ? count : 0, 0.0f);
  fill(field.confidence, options.confidence ? count : 0, 1.0f);
}

}  // namespace raymap
