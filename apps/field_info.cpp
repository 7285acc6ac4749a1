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
glm::ivec3 sizeOnLattice(const Field& band, const glm::ivec3& low, int side) {
  return glm::min(band.grid.dims - low, glm::ivec3(side));
}

size_t volumeOf(const glm::ivec3& size) {
  return size_t(size.x) * size_t(size.y) * size_t(size.z);
}

FieldInfo inspectBand(const Field& field) {
  const NarrowBand& band = *field.narrow;
  FieldInfo info{.samples = field.grid.sampleCount()};
  size_t rest = info.samples;
  for (size_t leaf = 0; leaf < band.leaves.size(); ++leaf) {
    const glm::ivec3 size = sizeOnLattice(field, band.leaves[leaf], NarrowBand::kLeafSide);
    const float* values = field.distance.data() + leaf * NarrowBand::kLeafSamples;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          count(values[(z * NarrowBand::kLeafSide + y) * NarrowBand::kLeafSide + x], 1, info);
    rest -= volumeOf(size);
  }
  for (const NarrowBand::Tile& tile : band.tiles) {
    const size_t samples = volumeOf(sizeOnLattice(field, tile.low, tile.side));
    count(-float(band.inside), samples, info);
    rest -= samples;
  }
  if (rest > 0) count(float(band.outside), rest, info);
  return info;
}

void printClamp(const Field& field) {
  const double spacing = field.grid.spacing;
  if (const auto& band = field.narrow) {
    std::printf("%-24s -%.9g and %.9g, %.4g and %.4g samples\n", "distances clamped to", band->inside,
                band->outside, band->inside / spacing, band->outside / spacing);
    printLine("active samples", grouped(field.activeCount()));
    printLine("leaves of 512 samples", grouped(band->leaves.size()));
  } else if (field.clampDistance > 0.0) {
    std::printf("%-24s %.9g, %.4g samples\n", "distances clamped to", field.clampDistance,
                field.clampDistance / spacing);
  }
}

}  // namespace

FieldInfo inspect(const Field& field) {
  if (field.narrow) return inspectBand(field);
  FieldInfo info{.array = heldArray(field), .samples = field.grid.sampleCount()};
  if (info.array == FieldArray::Triangle) return info;
  const Buffer<float>& values = info.array == FieldArray::Distance  ? field.distance
                                : info.array == FieldArray::Winding ? field.winding
                                                                    : field.confidence;
  for (const double value : values) count(value, 1, info);
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
  printLine("arrays", listOf(field.arrays()));
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

Json describe(const Field& field, const FieldInfo& info, const std::string& unit) {
  Json arrays = Json::array();
  for (const FieldArray array : field.arrays()) arrays.push_back(name(array));
  const bool isDistance = info.array == FieldArray::Distance;
  Json json{{"grid", figuresOf(field.grid)},
            {"unit", unit.empty() ? Json() : Json(unit)},
            {"arrays", arrays},
            {"surface_bounds", field.surfaceBounds.isEmpty() ? Json() : toJson(field.surfaceBounds)},
            {"clamp_distance", field.clamp()},
            {"array", name(info.array)},
            {"min", toJson(info.least)},
            {"max", toJson(info.most)},
            {"inside", isDistance ? Json(info.inside) : Json()},
            {"inside_share", isDistance ? Json(double(info.inside) / double(info.samples)) : Json()},
            {"non_finite", info.notFinite},
            {"band", nullptr}};
  if (const auto& band = field.narrow)
    json["band"] = {{"outside", band->outside},
                    {"inside", std::isfinite(band->inside) ? Json(band->inside) : Json()},
                    {"leaves", band->leaves.size()},
                    {"tiles", band->tiles.size()},
                    {"active", field.activeCount()}};
  return json;
}

}  // namespace raymap
