#include "field/field_sampler.h"

#include <raymap/error.h>

#include <string>

#include "base/require.h"
#include "base/text.h"

namespace raymap {

namespace {

std::string valuesOf(FieldArray array) {
  constexpr const char* kValues[] = {"distances", "winding numbers", "confidences", "triangles"};
  return kValues[static_cast<size_t>(array)];
}

}  // namespace

void validateGrid(const Grid& grid) {
  const glm::ivec3 dims = grid.dims;
  require(glm::all(glm::greaterThan(dims, glm::ivec3(0))),
          "the grid has " + std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " +
              std::to_string(dims.z) + " samples; every side needs at least one");
  require(grid.spacing > 0.0 && std::isfinite(grid.spacing),
          "the grid's spacing is " + numberText(grid.spacing) + "; it must be positive and finite");
  for (int axis = 0; axis < 3; ++axis)
    require(std::isfinite(grid.origin[axis]), std::string("the grid's origin has ") + "xyz"[axis] + " = " +
                                                  numberText(grid.origin[axis]) + "; it must be finite");
}

void validateField(const Field& field) {
  validateArray(field, FieldArray::Distance);
}

void validateArray(const Field& field, FieldArray array) {
  const std::string values = valuesOf(array);
  const size_t count = array == FieldArray::Triangle ? field.triangle.size() : numbersOf(field, array).size();
  if (count == 0) throw Error(ErrorCode::Usage, "the field is empty: it has no " + values);
  validateGrid(field.grid);
  if (count != field.grid.sampleCount())
    throw Error(ErrorCode::Usage, "the field holds " + std::to_string(count) + " " + values +
                                      " but its grid has " + std::to_string(field.grid.sampleCount()) +
                                      " samples");
}

void validateArray(const SparseField& band, FieldArray array) {
  validate(band);
  const bool isThere = array == FieldArray::Triangle   ? !band.triangle.empty()
                       : array == FieldArray::Distance ? true
                                                       : !numbersOf(band, array).empty();
  require(isThere, "the narrow band has no " + valuesOf(array) + "; ask for them in the options of the band");
}

}  // namespace raymap
