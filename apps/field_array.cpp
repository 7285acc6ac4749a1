#include "field_array.h"

#include <raymap/error.h>
#include <raymap/names.h>

namespace raymap {

namespace {

bool hasArray(const Field& field, FieldArray array) {
  switch (array) {
    case FieldArray::Distance:
      return field.narrow || !field.distance.empty();
    case FieldArray::Winding:
      return !field.winding.empty();
    case FieldArray::Confidence:
      return !field.confidence.empty();
    case FieldArray::Triangle:
      return !field.triangle.empty();
  }
  return false;
}

}  // namespace

Box boxOf(const Grid& grid) {
  return {grid.origin, grid.position(grid.dims - 1)};
}

std::vector<FieldArray> heldArrays(const Field& field) {
  std::vector<FieldArray> held;
  for (const std::string_view each : names<FieldArray>())
    if (const auto array = fromName<FieldArray>(each); hasArray(field, array)) held.push_back(array);
  return held;
}

FieldArray heldArray(const Field& field) {
  return heldArrays(field).front();
}

void requireDistances(const std::filesystem::path& path, const Field& field) {
  if (hasArray(field, FieldArray::Distance)) return;
  throw Error(ErrorCode::Usage, path.string() + ": it holds the array '" +
                                    std::string(name(heldArray(field))) +
                                    "', and no distances, which are needed here");
}

FieldArray chooseArray(const std::filesystem::path& path, const std::string& as, Field& field) {
  const FieldArray held = heldArray(field);
  if (as.empty()) return held;
  const auto asked = fromName<FieldArray>(as);
  if (hasArray(field, asked)) return asked;
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
