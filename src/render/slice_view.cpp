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
  axes_ = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
  columns_ = {grid.dims[axes_.x], grid.dims[axes_.y]};
  depth_ = index < 0 ? slices / 2 : index;
}

int SliceView::height(int width) const {
  const double rows = std::round(double(width) * columns_.y / columns_.x);
  return int(std::clamp(rows, 1.0, 2.0 * kMaxPictureSide));  // `makePicture` refuses larger heights.
}

}  // namespace raymap
