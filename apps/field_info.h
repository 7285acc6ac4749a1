#pragma once

#include <raymap/field.h>

#include <optional>
#include <string>

#include "report.h"

namespace raymap {

/// Figures of a field. Those of values leave out what is not finite, and triangles.
struct FieldInfo {
  FieldArray array = FieldArray::Distance;  ///< The array of the values.
  size_t samples = 0, inside = 0, notFinite = 0;
  std::optional<double> least, most;
};

/// Counts the values of the array that a field's file holds; of a narrow band, the distances of all samples.
FieldInfo inspect(const Field& field);

/// Prints the grid of a field, its arrays and figures. `unit`: that of all lengths, or empty.
void print(const Field& field, const FieldInfo& info, const std::string& unit);

/// Returns the same for programs.
Json describe(const Field& field, const FieldInfo& info, const std::string& unit);

}  // namespace raymap
