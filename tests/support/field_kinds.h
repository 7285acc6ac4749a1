#pragma once

// Fields of both kinds, for tests of what holds for each.

#include <gtest/gtest.h>
#include <raymap/narrow_band.h>

#include <string>
#include <utility>

namespace raymap {

enum class FieldKind { Dense, Narrow };

/// Returns a dense field as one of a kind. A band has the width to which the distances are clamped; if they
/// are not, all samples lie in it.
inline Field inKind(FieldKind kind, Field field) {
  if (kind == FieldKind::Dense) return field;
  const double width = field.clampDistance > 0.0 ? field.clampDistance / field.grid.spacing : 1e6;
  return toSparse(field, {.outside = width,
                          .inside = width,
                          .triangle = !field.triangle.empty(),
                          .winding = !field.winding.empty(),
                          .confidence = !field.confidence.empty()});
}

/// Returns the place of a sample's values, which a band must have.
inline size_t placeOf(const Field& field, const glm::ivec3& sample) {
  return field.narrow ? field.narrow->find(sample).value() : field.grid.index(sample);
}

/// Tests that run with fields of each kind.
class EachKind : public testing::TestWithParam<FieldKind> {
 protected:
  static Field made(Field dense) { return inKind(GetParam(), std::move(dense)); }
};

inline const auto kEachKind = testing::Values(FieldKind::Dense, FieldKind::Narrow);

inline std::string nameOfKind(const testing::TestParamInfo<FieldKind>& info) {
  return info.param == FieldKind::Dense ? "Dense" : "Narrow";
}

}  // namespace raymap
