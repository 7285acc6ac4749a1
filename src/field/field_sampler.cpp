#include "field/field_sampler.h"

#include <raymap/error.h>

#include <cfloat>
#include <cmath>
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

std::string placeProblem(const Grid& grid) {
  if (!(grid.spacing > 0.0) || !std::isfinite(grid.spacing))
    return "the grid's spacing is " + numberText(grid.spacing) + "; it must be positive and finite";
  if (!std::isnormal(grid.spacing))
    return "the grid's spacing is " + numberText(grid.spacing) + ", too small for double precision";
  const glm::dvec3 last = grid.position(grid.dims - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(1, "xyz"[axis]) + " = ";
    if (!std::isfinite(grid.origin[axis]))
      return "the grid's origin has " + name + numberText(grid.origin[axis]) + "; it must be finite";
    for (const double end : {grid.origin[axis], last[axis]})
      if (!(std::abs(end) <= FLT_MAX))
        return "the grid reaches to " + name + numberText(end) + ", and distances are known up to 3.4e38";
  }
  return {};
}

void validateGrid(const Grid& grid) {
  const glm::ivec3 dims = grid.dims;
  require(glm::all(glm::greaterThan(dims, glm::ivec3(0))),
          "the grid has " + std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " +
              std::to_string(dims.z) + " samples; every side needs at least one");
  const std::string problem = placeProblem(grid);
  require(problem.empty(), problem);
}

void validateArray(const Field& field, FieldArray array) {
  requireKnown(array, FieldArray::Triangle, "array");
  const std::string values = valuesOf(array);
  const size_t count = array == FieldArray::Triangle ? field.triangle.size() : numbersOf(field, array).size();
  if (field.narrow) {
    validate(field);
    require(array == FieldArray::Distance || count > 0,
            "the narrow band has no " + values + "; ask for them in the options of the band");
    return;
  }
  if (count == 0) throw Error(ErrorCode::Usage, "the field is empty: it has no " + values);
  validateGrid(field.grid);
  if (count != field.grid.sampleCount())
    throw Error(ErrorCode::Usage, "the field holds " + std::to_string(count) + " " + values +
                                      " but its grid has " + std::to_string(field.grid.sampleCount()) +
                                      " samples");
}

void requireDense(const Field& field) {
  require(!field.narrow, "the field is a narrow band, and a dense one is needed; make it dense first");
}

void requireNarrow(const Field& field) {
  require(field.narrow.has_value(), "the field is dense, and a narrow band is needed; make it one first");
}

}  // namespace raymap
