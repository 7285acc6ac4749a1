#include "scene/shown_numbers.h"

namespace raymap {

ShownNumbers::ShownNumbers(const DrawnField& field, const RenderOptions& options)
    : colouring_(options.other
                     ? differenceColouring(options.range > 0.0 ? options.range / field.grid().spacing : 1.0)
                     : colouringOf(options.array)),
      isDifference_(options.other != nullptr),
      last_(field.last()),
      source_(sourceOf(field, options)) {}

double ShownNumbers::at(const glm::dvec3& p) const {
  const glm::dvec3 q = glm::clamp(p, glm::dvec3(0.0), last_);
  return std::visit([&](const auto& source) { return source(q); }, source_);
}

ShownNumbers::Source ShownNumbers::sourceOf(const DrawnField& field, const RenderOptions& options) {
  const glm::ivec3 dims = field.grid().dims;
  if (const LeafTree* tree = field.tree())
    return OfLeaves{{dims, {tree, &numbersOf(tree->band(), options.array)}}};
  const Field& first = *field.dense();
  const Buffer<float>& numbers = numbersOf(options.other ? *options.other : first, options.array);
  OfDense dense{.numbers = numbers, .between = {dims, numbers.data()}, .base = {}, .scale = 1.0};
  if (options.other) {
    dense.base.emplace(dims, first.distance.data());
    dense.scale = 1.0 / first.grid.spacing;
  }
  return dense;
}

}  // namespace raymap
