#include "field_info.h"

#include <raymap/json.h>
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

/// Counts a value of some samples.
void count(double value, size_t samples, FieldInfo& info) {
  if (!std::isfinite(value)) {
    info.notFinite += samples;
    return;
  }
  info.inside += value < 0.0 ? samples : 0;
  info.least = std::min(info.least.value_or(value), value);
  info.most = std::max(info.most.value_or(value), value);
}

/// Returns the samples of a cube that lie on the lattice, along each axis.
glm::ivec3 sizeOnLattice(const SparseField& band, const glm::ivec3& low, int side) {
  return glm::min(band.grid.dims - low, glm::ivec3(side));
}

size_t volumeOf(const glm::ivec3& size) {
  return size_t(size.x) * size_t(size.y) * size_t(size.z);
}

}  // namespace

FieldInfo inspect(const Field& field) {
  FieldInfo info{.array = heldArray(field), .samples = field.grid.sampleCount()};
  if (info.array == FieldArray::Triangle) return info;
  const Buffer<float>& values = info.array == FieldArray::Distance  ? field.distance
                                : info.array == FieldArray::Winding ? field.winding
                                                                    : field.confidence;
  for (const double value : values) count(value, 1, info);
  return info;
}

FieldInfo inspect(const SparseField& band) {
  FieldInfo info{.samples = band.grid.sampleCount()};
  size_t rest = info.samples;
  for (size_t leaf = 0; leaf < band.leaves.size(); ++leaf) {
    const glm::ivec3 size = sizeOnLattice(band, band.leaves[leaf], SparseField::kLeafSide);
    const float* values = band.distance.data() + leaf * SparseField::kLeafSamples;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          count(values[(z * SparseField::kLeafSide + y) * SparseField::kLeafSide + x], 1, info);
    rest -= volumeOf(size);
  }
  for (const SparseField::Tile& tile : band.tiles) {
    const size_t samples = volumeOf(sizeOnLattice(band, tile.low, tile.side));
    count(-float(band.inside), samples, info);
    rest -= samples;
  }
  if (rest > 0) count(float(band.outside), rest, info);
  return info;
}

namespace {

void printClamp(const Field& field) {
  if (field.clampDistance > 0.0)
    std::printf("%-24s %.9g, %.4g samples\n", "distances clamped to", field.clampDistance,
                field.clampDistance / field.grid.spacing);
}

void printClamp(const SparseField& band) {
  std::printf("%-24s -%.9g and %.9g, %.4g and %.4g samples\n", "distances clamped to", band.inside,
              band.outside, band.inside / band.grid.spacing, band.outside / band.grid.spacing);
  printLine("active samples", grouped(band.activeCount()));
  printLine("leaves of 512 samples", grouped(band.leaves.size()));
}

double clampDistanceOf(const Field& field) {
  return field.clampDistance;
}
double clampDistanceOf(const SparseField& band) {
  return std::min(band.inside, band.outside);
}

template <class AnyField>
void printAny(const AnyField& field, const FieldInfo& info, const std::string& unit) {
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
  printClamp(field);
  if (info.least) std::printf("%-24s %.9g to %.9g\n", nameOf(info.array), *info.least, *info.most);
  if (info.array == FieldArray::Distance)
    std::printf("%-24s %s, %.4g %%\n", "samples inside", grouped(info.inside).c_str(),
                100.0 * double(info.inside) / double(info.samples));
  if (info.notFinite > 0) printLine("values not finite", grouped(info.notFinite));
}

template <class AnyField>
Json describeAny(const AnyField& field, const FieldInfo& info, const std::string& unit) {
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
          {"clamp_distance", clampDistanceOf(field)},
          {"array", name(info.array)},
          {"min", toJson(info.least)},
          {"max", toJson(info.most)},
          {"inside", isDistance ? Json(info.inside) : Json()},
          {"inside_share", isDistance ? Json(double(info.inside) / double(info.samples)) : Json()},
          {"non_finite", info.notFinite}};
}

}  // namespace

void print(const Field& field, const FieldInfo& info, const std::string& unit) {
  printAny(field, info, unit);
}

void print(const SparseField& band, const FieldInfo& info, const std::string& unit) {
  printAny(band, info, unit);
}

Json describe(const Field& field, const FieldInfo& info, const std::string& unit) {
  return describeAny(field, info, unit);
}

Json describe(const SparseField& band, const FieldInfo& info, const std::string& unit) {
  Json json = describeAny(band, info, unit);
  json["band"] = {{"outside", band.outside},
                  {"inside", std::isfinite(band.inside) ? Json(band.inside) : Json()},
                  {"leaves", band.leaves.size()},
                  {"tiles", band.tiles.size()},
                  {"active", band.activeCount()}};
  return json;
}

}  // namespace raymap
