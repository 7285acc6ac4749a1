#include "render/slice_view.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

namespace raymap {

SliceView::SliceView(const Grid& grid, int axis, int index) {
  if (axis < 0 || axis > 2)
    throw Error(ErrorCode::Usage, "axis " + std::to_string(axis) + " does not exist: 0, 1 or 2 is x, y or z");
  const int slices = grid.dims[axis];
  if (index < -1 || index >= slices)
    throw Error(ErrorCode::Usage, "slice " + std::to_string(index) +
                                      " does not exist: the grid has slices 0 to " +
                                      std::to_string(slices - 1) + " across " + "xyz"[axis]);
  const size_t strides[] = {1, size_t(grid.dims.x), size_t(grid.dims.x) * size_t(grid.dims.y)};
  const int right = axis == 0 ? 1 : 0;
  const int up = axis == 2 ? 1 : 2;
  columns_ = {grid.dims[right], grid.dims[up]};
  strides_[0] = strides[right];
  strides_[1] = strides[up];
  first_ = strides[axis] * size_t(index < 0 ? slices / 2 : index);
}

int SliceView::height(int width) const {
  const double rows = std::round(double(width) * columns_.y / columns_.x);
  return int(std::clamp(rows, 1.0, 2.0 * kMaxPictureSide));  // `makePicture` refuses larger heights.
}

double SliceView::value(const Buffer<float>& samples, glm::dvec2 at) const {
  const glm::dvec2 q = glm::clamp(at, glm::dvec2(0.0), glm::dvec2(columns_ - 1));
  const glm::ivec2 low = glm::ivec2(q);
  const glm::ivec2 high = glm::min(low + 1, columns_ - 1);
  const glm::dvec2 t = q - glm::dvec2(low);
  const auto row = [&](int y) {
    const double left = samples[index({low.x, y})];
    return t.x > 0.0 ? left + t.x * (samples[index({high.x, y})] - left) : left;
  };
  const double below = row(low.y);
  return t.y > 0.0 ? below + t.y * (row(high.y) - below) : below;
}

double SliceView::slope(const Buffer<float>& samples, glm::dvec2 at, double pixel) const {
  const glm::dvec2 right(0.5 * pixel, 0.0), up(0.0, 0.5 * pixel);
  return std::hypot(value(samples, at + right) - value(samples, at - right),
                    value(samples, at + up) - value(samples, at - up));
}

}  // namespace raymap
