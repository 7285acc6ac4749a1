#include "state.h"

#include <raymap/names.h>

namespace raymap::view {

std::string Colours::name() const {
  return isDifference ? "difference" : std::string(raymap::name(array));
}

void Colours::choose(ViewState& state) const {
  state.view.array = array;
  state.isDifferenceShown = isDifference;
}

std::vector<Colours> coloursOf(const Content& content, const Content* other) {
  std::vector<Colours> all{{}};
  const auto add = [&](FieldArray array, const raymap::Buffer<float> Field::*numbers) {
    if (!content.field || !((*content.field).*numbers).empty()) all.push_back({.array = array});
  };
  add(FieldArray::Winding, &Field::winding);
  add(FieldArray::Confidence, &Field::confidence);
  if (other) all.push_back({.isDifference = true});
  return all;
}

}  // namespace raymap::view
