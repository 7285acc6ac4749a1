#include "field_array.h"

#include <raymap/error.h>
#include <raymap/names.h>

namespace raymap {

Box boxOf(const Grid& grid) {
  return {grid.origin, grid.position(grid.dims - 1)};
}

FieldArray heldArray(const Field& field) {
  return field.arrays().front();
}

void requireDistances(const std::filesystem::path& path, const Field& field) {
  if (field.has(FieldArray::Distance)) return;
  throw Error(ErrorCode::Usage, path.string() + ": it holds the array '" +
                                    std::string(name(heldArray(field))) +
                                    "', and no distances, which are needed here");
}

FieldArray chooseArray(const std::filesystem::path& path, const std::string& as, Field& field) {
  const FieldArray held = heldArray(field);
  if (as.empty()) return held;
  const auto asked = fromName<FieldArray>(as);
  if (field.has(asked)) return asked;
  if (field.narrow)
    throw Error(ErrorCode::Usage,
                path.string() + ": it does not hold the array '" + as + "'; leave out --as");
  const bool isNumber = asked == FieldArray::Winding || asked == FieldArray::Confidence;
  if (held != FieldArray::Distance || !isNumber)
    throw Error(ErrorCode::Usage, path.string() + ": it holds the array '" + std::string(name(held)) +
                                      "', not '" + as + "'; leave out --as");
  (asked == FieldArray::Winding ? field.winding : field.confidence) = std::move(field.distance);
  return asked;
}

}  // namespace raymap
