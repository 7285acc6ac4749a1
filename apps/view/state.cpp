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
  const auto& field = content.field;
  if (!field || !field->winding.empty()) all.push_back({.array = FieldArray::Winding});
  if (!field || !field->confidence.empty()) all.push_back({.array = FieldArray::Confidence});
  if (other) all.push_back({.isDifference = true});
  return all;
}

}  // namespace raymap::view
