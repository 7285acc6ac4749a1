// A slice of a field as a map: shaded by value, with iso-lines and the contour of the surface.

#include <algorithm>

#include "render/array_reader.h"
#include "render/slice_view.h"

namespace raymap {

namespace {

struct Range {
  double inside = 0.0;
  double outside = 0.0;
};

// Least distance of iso-lines, in pixels.
constexpr double kLeastGap = 8.0;

/// Returns the largest finite distances inside and outside in the slice. With a band it returns twice the
/// band's width. The band's plateau, which only means "far", then gets the middle of the colour ramp.
template <class Numbers>
Range findRange(const Numbers& distances, double band, const SliceView& view) {
  if (band > 0.0) return {2.0 * band, 2.0 * band};
  Range range;
  for (int y = 0; y < view.size().y; ++y)
    for (int x = 0; x < view.size().x; ++x) {
      const double value = distances(view.sample({x, y}));
      if (!std::isfinite(value)) continue;
      range.inside = std::max(range.inside, -value);
      range.outside = std::max(range.outside, value);
    }
  return range;
}

/// `band` is `Field::clampDistance`.
template <class Numbers>
Picture drawDistance(const Numbers& distances, double band, double spacing, const SliceView& view,
                     int width) {
  const double pixel = view.pixelSize(width);
  const double plain = 0.1 * pixel * spacing;  // A smaller slope is a plateau, not a line.
  const Range range = findRange(distances, band, view);
  const double step =
      roundedUp(std::max(std::max(range.inside, range.outside) / 25.0, kLeastGap * pixel * spacing));

  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(distances, at);
    if (!std::isfinite(value)) return kNotFinite;
    const Colour ground = distanceColour(value, value < 0.0 ? range.inside : range.outside);
    const double slope = view.slope(distances, at, pixel);
    if (!(slope > plain)) return ground;
    return drawContour(drawIsoLines(ground, value, slope, step), value, slope, kContour);
  });
}

template <class Numbers>
Picture drawWinding(const Numbers& windings, const SliceView& view, int width) {
  const double pixel = view.pixelSize(width);
  const double plain = 1e-3 * pixel;  // As for distances.
  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(windings, at);
    if (!std::isfinite(value)) return kNotFinite;
    const Colour ground = windingColour(value);
    const double beyond = std::abs(value) - 0.5, slope = view.slope(windings, at, pixel);
    if (!(slope > plain)) return ground;
    return drawContour(beyond > 0.5 ? drawIsoLines(ground, beyond, slope, 1.0) : ground, beyond, slope,
                       kContour);
  });
}

template <class Numbers>
Picture drawConfidence(const Numbers& confidences, const SliceView& view, int width) {
  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(confidences, at);
    return std::isfinite(value) ? confidenceColour(value) : kNotFinite;
  });
}

/// Draws an array in its colours.
template <class Array>
Picture drawArray(const Array& array, int axis, int index, int width) {
  makePicture(width, 1);  // Throws for an invalid width, by which `pixelSize` divides.
  const SliceView view(array.grid(), axis, index);
  if (array.kind() == FieldArray::Winding) return drawWinding(array, view, width);
  if (array.kind() == FieldArray::Confidence) return drawConfidence(array, view, width);
  if (array.kind() == FieldArray::Triangle)
    return view.paint(width, [&](glm::dvec2 at) { return triangleColour(array.triangle(view.nearest(at))); });
  return drawDistance(array, array.clampDistance(), array.grid().spacing, view, width);
}

}  // namespace

Picture renderSlice(const Field& field, int axis, int index, int width, FieldArray array) {
  return field.narrow ? drawArray(BandArray(field, array), axis, index, width)
                      : drawArray(DenseArray(field, array), axis, index, width);
}

}  // namespace raymap
