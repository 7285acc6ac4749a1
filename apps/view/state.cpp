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
  const auto addThoseOf = [&](const auto& field) {
    if (!field.winding.empty()) all.push_back({.array = FieldArray::Winding});
    if (!field.confidence.empty()) all.push_back({.array = FieldArray::Confidence});
  };
  if (content.field) addThoseOf(*content.field);
  if (content.band) addThoseOf(*content.band);
  if (!content.isField())
    for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence})
      all.push_back({.array = array});
  if (other) all.push_back({.isDifference = true});
  return all;
}

}  // namespace raymap::view
