#pragma once

#include <raymap/render.h>

#include <algorithm>
#include <cmath>

#include "picture/colour.h"

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
  /// Returns the sample in a column and row of the slice.
  glm::ivec3 sample(glm::ivec2 at) const {
    glm::ivec3 sample;
    sample[axes_.x] = at.x;
    sample[axes_.y] = at.y;
    sample[3 - axes_.x - axes_.y] = depth_;
    return sample;
  }
  /// Returns the sample whose square holds a position.
  glm::ivec3 nearest(glm::dvec2 at) const {
    return sample(glm::clamp(glm::ivec2(glm::floor(at + 0.5)), glm::ivec2(0), columns_ - 1));
  }
  /// Returns the bilinear value between samples; constant beyond the outermost ones. `read(sample)` returns
  /// the number of a sample.
  template <class Read>
  double value(const Read& read, glm::dvec2 at) const {
    const glm::dvec2 q = glm::clamp(at, glm::dvec2(0.0), glm::dvec2(columns_ - 1));
    const glm::ivec2 low = glm::ivec2(q);
    const glm::ivec2 high = glm::min(low + 1, columns_ - 1);
    const glm::dvec2 t = q - glm::dvec2(low);
    const auto row = [&](int y) {
      const double left = read(sample({low.x, y}));
      return t.x > 0.0 ? left + t.x * (read(sample({high.x, y})) - left) : left;
    };
    const double below = row(low.y);
    return t.y > 0.0 ? below + t.y * (row(high.y) - below) : below;
  }
  /// Returns the change of the value across a pixel.
  template <class Read>
  double slope(const Read& read, glm::dvec2 at, double pixel) const {
    const glm::dvec2 right(0.5 * pixel, 0.0), up(0.0, 0.5 * pixel);
    return std::hypot(value(read, at + right) - value(read, at - right),
                      value(read, at + up) - value(read, at - up));
  }

 private:
  int height(int width) const;

  glm::ivec2 columns_;  // Number of samples right and up.
  glm::ivec2 axes_;     // Axes that point right and up.
  int depth_;           // Sample along the third axis.
};

}  // namespace raymap
