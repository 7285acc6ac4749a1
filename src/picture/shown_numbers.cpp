#include "picture/shown_numbers.h"

#include <limits>
#include <utility>

#include "base/require.h"

namespace raymap {

namespace {

/// Returns the least difference in the deepest colour, in samples.
double rangeOf(const RenderOptions& options, const Grid& grid) {
  return options.range > 0.0 ? options.range / grid.spacing : 1.0;
}

}  // namespace

ShownNumbers::ShownNumbers(const DrawnField& field, const RenderOptions& options)
    : isDifference_(options.other != nullptr),
      colouring_(isDifference_ ? differenceColouring(rangeOf(options, field.grid()))
                               : colouringOf(options.array)),
      last_(field.last()),
      source_(sourceOf(field, options)) {}

double ShownNumbers::at(const glm::dvec3& p) const {
  const glm::dvec3 q = glm::clamp(p, glm::dvec3(0.0), last_);
  return std::visit([&](const auto& source) { return source(q); }, source_);
}

double ShownNumbers::OfBand::operator()(const glm::dvec3& p) const {
  const DrawnField::Reading a = first->reading(p), b = other.reading(scale * p + shift);
  const double difference = b.value / scale - a.value;
  const bool mayBeMore = b.mayBeMore || a.mayBeLess, mayBeLess = b.mayBeLess || a.mayBeMore;
  const bool isKnown = (!mayBeMore || difference >= range) && (!mayBeLess || difference <= -range);
  return isKnown ? difference : std::numeric_limits<double>::quiet_NaN();
}

ShownNumbers::Source ShownNumbers::sourceOf(const DrawnField& field, const RenderOptions& options) {
  const Grid& grid = field.grid();
  const glm::ivec3 dims = grid.dims;
  if (field.tree() && options.other) {
    DrawnField other(*options.other);
    const Grid from = other.grid();
    return OfBand{.first = &field,
                  .other = std::move(other),
                  .scale = grid.spacing / from.spacing,
                  .shift = (grid.origin - from.origin) / from.spacing,
                  .range = rangeOf(options, grid)};
  }
  require(!options.other || !options.other->narrow,
          "a picture of a dense field shows no difference from a narrow band; make that dense by toDense");
  if (const LeafTree* tree = field.tree()) {
    const Buffer<float>& numbers = numbersOf(field.field(), options.array);
    return OfLeaves{numbers, {dims, {tree, &numbers}}};
  }
  const Field& first = field.field();
  const Buffer<float>& numbers = numbersOf(options.other ? *options.other : first, options.array);
  OfDense dense{.numbers = numbers, .between = {dims, numbers.data()}, .base = {}, .scale = 1.0};
  if (options.other) {
    dense.base.emplace(dims, first.distance.data());
    dense.scale = 1.0 / grid.spacing;
  }
  return dense;
}

}  // namespace raymap
