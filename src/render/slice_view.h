#pragma once

#include <raymap/render.h>

#include <algorithm>
#include <cmath>

#include "scene/colour.h"

namespace raymap {

/// A slice of a grid laid out as a picture, as `renderSlice` documents it. Positions in the slice are in
/// samples: (right, up).
class SliceView {
 public:
  /// Selects a slice; `index` -1 is the middle. Throws `Error(Usage)` for an axis or index that does not
  /// exist.
  SliceView(const Grid& grid, int axis, int index);

  /// Returns a picture of square pixels with the colours `colour(position)`.
  template <class Paint>
  Picture paint(int width, Paint&& colour) const {
    Picture picture = makePicture(width, height(width));
    const double pixel = pixelSize(width);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        setPixel(picture, x, y,
                 colour(glm::dvec2((x + 0.5) * pixel - 0.5, columns_.y - 0.5 - (y + 0.5) * pixel)));
    return picture;
  }

  /// Returns the side of a pixel, in samples.
  double pixelSize(int width) const { return double(columns_.x) / width; }
  glm::ivec2 size() const { return columns_; }
  /// Returns the index in the field's arrays of the sample in a column and row of the slice.
  size_t index(glm::ivec2 at) const {
    return first_ + size_t(at.x) * strides_[0] + size_t(at.y) * strides_[1];
  }
  /// Returns the index of the sample whose square holds a position.
  size_t nearest(glm::dvec2 at) const {
    return index(glm::clamp(glm::ivec2(glm::floor(at + 0.5)), glm::ivec2(0), columns_ - 1));
  }
  /// Returns the bilinear value between samples; constant beyond the outermost ones.
  double value(const Buffer<float>& samples, glm::dvec2 at) const;
  /// Returns the change of the value across a pixel.
  double slope(const Buffer<float>& samples, glm::dvec2 at, double pixel) const;

 private:
  int height(int width) const;

  glm::ivec2 columns_;  // Number of samples right and up.
  size_t strides_[2];
  size_t first_;
};

}  // namespace raymap
