#include <raymap/error.h>
#include <raymap/render.h>

#include "base/require.h"
#include "picture/colour.h"
#include "picture/colouring.h"

namespace raymap {

namespace {

template <class ColourOf>
ColourBar barOf(double least, double most, int count, ColourOf&& colourOf) {
  require(count >= 2, "a colour bar has at least 2 colours");
  ColourBar bar{.least = least, .most = most};
  Picture pixel = makePicture(1, 1);
  for (int i = 0; i < count; ++i) {
    setPixel(pixel, 0, 0, colourOf(glm::mix(least, most, i / double(count - 1))));
    bar.colours.push_back({pixel.rgb[0], pixel.rgb[1], pixel.rgb[2]});
  }
  return bar;
}

}  // namespace

ColourBar colourBar(const RenderOptions& options, int count) {
  require(options.array != FieldArray::Triangle, "triangles have no colour bar: neighbours differ");
  if (options.array == FieldArray::Confidence) return barOf(0.0, 1.0, count, confidenceColour);
  if (options.array == FieldArray::Winding) return barOf(-1.0, 2.0, count, windingColour);
  require(options.frame.has_value(), "the colours of distances need the box of the shape; give a frame");
  // As `Shape` measures them.
  const glm::dvec3 size = options.frame->size();
  const double solid = options.iso + 0.5 * std::min({size.x, size.y, size.z}),
               radius = 0.5 * glm::length(size);
  const double depth = options.shell > 0.0 ? std::min(options.shell, solid) : solid;
  return barOf(options.iso - depth, options.iso + radius, count, [&](double number) {
    const double d = number - options.iso;
    return distanceColour(d, d < 0.0 ? depth : radius);
  });
}

ColourBar differenceBar(double range, int count) {
  require(range > 0.0, "the range of differences must be positive");
  return barOf(-range, range, count,
               [colouring = differenceColouring(range)](double number) { return colouring.at(number); });
}

}  // namespace raymap
