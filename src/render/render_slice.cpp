// A slice of a field as a map: shaded by value, with iso-lines and the contour of the surface.

#include <algorithm>

#include "field/field_sampler.h"
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
Range findRange(const Field& field, const SliceView& view) {
  Range range;
  for (int y = 0; y < view.size().y; ++y)
    for (int x = 0; x < view.size().x; ++x) {
      const double value = field.distance[view.index({x, y})];
      if (!std::isfinite(value)) continue;
      range.inside = std::max(range.inside, -value);
      range.outside = std::max(range.outside, value);
    }
  if (field.clampDistance > 0.0) range = {2.0 * field.clampDistance, 2.0 * field.clampDistance};
  return range;
}

Picture drawDistance(const Field& field, const SliceView& view, int width) {
  const double pixel = view.pixelSize(width);
  const double plain = 0.1 * pixel * field.grid.spacing;  // A smaller slope is a plateau, not a line.
  const Range range = findRange(field, view);
  const double step = roundedUp(
      std::max(std::max(range.inside, range.outside) / 25.0, kLeastGap * pixel * field.grid.spacing));

  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(field.distance, at);
    if (!std::isfinite(value)) return kNotFinite;
    const Colour ground = distanceColour(value, value < 0.0 ? range.inside : range.outside);
    const double slope = view.slope(field.distance, at, pixel);
    if (!(slope > plain)) return ground;
    return drawContour(drawIsoLines(ground, value, slope, step), value, slope, kContour);
  });
}

Picture drawWinding(const Field& field, const SliceView& view, int width) {
  const double pixel = view.pixelSize(width);
  const double plain = 1e-3 * pixel;  // As for distances.
  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(field.winding, at);
    if (!std::isfinite(value)) return kNotFinite;
    const Colour ground = windingColour(value);
    const double beyond = std::abs(value) - 0.5, slope = view.slope(field.winding, at, pixel);
    if (!(slope > plain)) return ground;
    return drawContour(beyond > 0.5 ? drawIsoLines(ground, beyond, slope, 1.0) : ground, beyond, slope,
                       kContour);
  });
}

Picture drawConfidence(const Field& field, const SliceView& view, int width) {
  return view.paint(width, [&](glm::dvec2 at) {
    const double value = view.value(field.confidence, at);
    return std::isfinite(value) ? confidenceColour(value) : kNotFinite;
  });
}

}  // namespace

Picture renderSlice(const Field& field, int axis, int index, int width, FieldArray array) {
  validateArray(field, array);
  makePicture(width, 1);  // Throws for an invalid width, by which `pixelSize` divides.
  const SliceView view(field.grid, axis, index);
  if (array == FieldArray::Winding) return drawWinding(field, view, width);
  if (array == FieldArray::Confidence) return drawConfidence(field, view, width);
  if (array == FieldArray::Triangle)
    return view.paint(width, [&](glm::dvec2 at) { return triangleColour(field.triangle[view.nearest(at)]); });
  return drawDistance(field, view, width);
}

}  // namespace raymap
