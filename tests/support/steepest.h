#pragma once

#include <raymap/field.h>

#include <algorithm>
#include <cmath>

namespace raymap {

/// Returns the largest change of the signed distance between adjacent samples, in spacings. It is 1 in a true
/// distance field.
inline double steepest(const Field& field) {
  const glm::ivec3& dims = field.grid.dims;
  double steepest = 0.0;
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 next(i, j, k);
          if (++next[axis] == dims[axis]) continue;
          const double change =
              field.distance[field.grid.index(next)] - field.distance[field.grid.index({i, j, k})];
          steepest = std::max(steepest, std::abs(change) / field.grid.spacing);
        }
  return steepest;
}

}  // namespace raymap
