#include "field_info.h"

#include <raymap/names.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "field_array.h"

namespace raymap {

namespace {

std::string listOf(const std::vector<FieldArray>& arrays) {
  std::string text;
  for (const FieldArray array : arrays) text += (text.empty() ? "" : ", ") + std::string(name(array));
  return text;
}

void printLine(const char* what, const std::string& text) {
  std::printf("%-24s %s\n", what, text.c_str());
}

void printLine(const char* what, const glm::dvec3& v) {
  std::printf("%-24s %.9g %.9g %.9g\n", what, v.x, v.y, v.z);
}

/// Returns the name of the values' line.
const char* nameOf(FieldArray array) {
  return array == FieldArray::Distance  ? "distances"
         : array == FieldArray::Winding ? "winding numbers"
                                        : "confidences";
}

}  // namespace

FieldInfo inspect(const Field& field) {
  FieldInfo info{.array = heldArray(field), .samples = field.grid.sampleCount()};
  if (info.array == FieldArray::Triangle) return info;
  const Buffer<float>& values = info.array == FieldArray::Distance  ? field.distance
                                : info.array == FieldArray::Winding ? field.winding
                                                                    : field.confidence;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      ++info.notFinite;
      continue;
    }
    info.inside += value < 0.0 ? 1 : 0;
    info.least = std::min(info.least.value_or(value), value);
    info.most = std::max(info.most.value_or(value), value);
  }
  return info;
}

void print(const Field& field, const FieldInfo& info, const std::string& unit) {
  const Grid& grid = field.grid;
  const Box box = boxOf(grid), &surface = field.surfaceBounds;
  const std::string by = " x ", dims = std::to_string(grid.dims.x) + by + std::to_string(grid.dims.y) + by +
                                       std::to_string(grid.dims.z);
  printLine("samples", dims + " = " + grouped(info.samples));
  printLine("first sample (origin)", grid.origin);
  printLine("last sample", box.max);
  std::printf("%-24s %.9g\n", "spacing", grid.spacing);
  printLine("unit", unit.empty() ? "not stated" : unit);
  printLine("arrays", listOf(heldArrays(field)));
  if (surface.isEmpty()) {
    printLine("surface, lowest", "not known");
  } else {
    printLine("surface, lowest", surface.min);
    printLine("surface, highest", surface.max);
  }
  if (field.clampDistance > 0.0)
    std::printf("%-24s %.9g, %.4g samples\n", "distances clamped to", field.clampDistance,
                field.clampDistance / grid.spacing);
  if (info.least) std::printf("%-24s %.9g to %.9g\n", nameOf(info.array), *info.least, *info.most);
  if (info.array == FieldArray::Distance)
    std::printf("%-24s %s, %.4g %%\n", "samples inside", grouped(info.inside).c_str(),
                100.0 * double(info.inside) / double(info.samples));
  if (info.notFinite > 0) printLine("values not finite", grouped(info.notFinite));
}

Json describe(const Field& field, const FieldInfo& info, const std::string& unit) {
  Json arrays = Json::array();
  for (const FieldArray array : heldArrays(field)) arrays.push_back(name(array));
  const bool isDistance = info.array == FieldArray::Distance;
  return {{"grid",
           {{"dims", toJson(field.grid.dims)},
            {"origin", toJson(field.grid.origin)},
            {"spacing", field.grid.spacing},
            {"samples", info.samples}}},
          {"unit", unit.empty() ? Json() : Json(unit)},
          {"arrays", arrays},
          {"surface_bounds", field.surfaceBounds.isEmpty() ? Json() : toJson(field.surfaceBounds)},
          {"clamp_distance", field.clampDistance},
          {"array", name(info.array)},
          {"min", toJson(info.least)},
          {"max", toJson(info.most)},
          {"inside", isDistance ? Json(info.inside) : Json()},
          {"inside_share", isDistance ? Json(double(info.inside) / double(info.samples)) : Json()},
          {"non_finite", info.notFinite}};
}

}  // namespace raymap
