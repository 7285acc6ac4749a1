#include "picture/colouring.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

template <class ColourOf>
std::vector<Colouring::Stop> stopsAt(std::initializer_list<double> numbers, ColourOf&& colourOf) {
  std::vector<Colouring::Stop> stops;
  for (const double number : numbers) stops.push_back({number, colourOf(number)});
  return stops;
}

}  // namespace

Colour Colouring::at(double number) const {
  if (std::isnan(number)) return kNotFinite;
  Colour mixed = stops[0].colour;
  for (size_t i = 1; i < stops.size(); ++i) {
    const double low = stops[i - 1].number, high = stops[i].number;
    mixed = glm::mix(mixed, stops[i].colour, std::clamp((number - low) / (high - low), 0.0, 1.0));
  }
  return mixed;
}

Colouring colouringOf(FieldArray array) {
  constexpr double kOver = 0.5 + 1e-6;
  if (array == FieldArray::Confidence)
    return {.stops = stopsAt({0.0, 0.5, 1.0}, confidenceColour), .lineStep = 0.2, .isOnSurface = true};
  return {.stops = stopsAt({-3.0, -2.0, -1.0, -kOver, -0.5, 0.0, 0.5, kOver, 1.0, 2.0, 3.0}, windingColour)};
}

Colouring differenceColouring(double range) {
  const Colour colours[] = {srgb(33, 102, 172), srgb(146, 197, 222), srgb(245, 245, 245), srgb(244, 165, 130),
                            srgb(178, 24, 43)};
  Colouring colouring{.lineStep = roundedUp(range / 5.0), .isOnSurface = true};
  for (int i = 0; i < 5; ++i) colouring.stops.push_back({0.5 * (i - 2) * range, colours[i]});
  return colouring;
}

}  // namespace raymap
