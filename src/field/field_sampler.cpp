#include "field/field_sampler.h"

#include <raymap/error.h>

#include <string>

namespace raymap {

void validateGrid(const Grid& grid) {
  const glm::ivec3 dims = grid.dims;
  if (glm::any(glm::lessThan(dims, glm::ivec3(1))) || !(grid.spacing > 0.0) || !std::isfinite(grid.spacing))
    throw Error(ErrorCode::Usage, "the field is empty: its grid has " + std::to_string(dims.x) + " x " +
                                      std::to_string(dims.y) + " x " + std::to_string(dims.z) +
                                      " samples at a spacing of " + std::to_string(grid.spacing));
}

void validateField(const Field& field) {
  validateGrid(field.grid);
  if (field.distance.size() != field.grid.sampleCount())
    throw Error(ErrorCode::Usage, "the field holds " + std::to_string(field.distance.size()) +
                                      " distances but its grid has " +
                                      std::to_string(field.grid.sampleCount()) + " samples");
}

}  // namespace raymap
