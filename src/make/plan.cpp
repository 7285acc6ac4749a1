#include "make/plan.h"

#include <raymap/names.h>
#include <raymap/surface.h>
#include <raymap/version.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "base/memory.h"
#include "base/require.h"
#include "base/text.h"
#include "cpu/points/region.h"
#include "field/field_sampler.h"
#include "io/file_format.h"

namespace raymap {

namespace {

using Path = std::filesystem::path;

bool isOneOf(const Path& path, const FieldFiles& files, const Formats& formats) {
  return contains(formats, formatOf(path, files.format, fieldExtensions()));
}

/// Returns the number of samples, or 2^56 for more than any memory holds.
size_t samplesOf(const Grid& grid) {
  constexpr double kMost = double(size_t{1} << 56);
  return size_t(std::min(double(grid.dims.x) * double(grid.dims.y) * double(grid.dims.z), kMost));
}

size_t arrayCount(const FieldOptions& options) {
  return size_t{1} + options.triangle + options.winding + options.confidence;
}

/// Returns whether the field is what a `Surface` gives at the samples.
bool isOfSurface(const MeshView& mesh, const FieldOptions& o, const MachineOptions& machine) {
  return mesh.triangleCount > 0 && o.distance == DistanceMode::Exact && o.sign == SignMode::Harmonic &&
         !o.closeHoles && !o.invert && o.thickness == 0.0 && !machine.device.starts_with("vulkan");
}

/// Returns whether a field is made near the surface alone, which takes less time and memory for so many
/// samples. Only a .vdb and a .nvdb have no place for the others.
bool isNarrowBand(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                  const FieldFiles& files, const MachineOptions& machine) {
  constexpr size_t kManySamples = size_t{1} << 24;
  const bool isPossible = options.band > 0.0 && isOneOf(files.distance, files, {".vdb", ".nvdb"}) &&
                          isOfSurface(mesh, options, machine) && arrayCount(options) == 1;
  return isPossible && (files.fullInside || samplesOf(grid) > kManySamples);
}

/// Throws `Error(Usage)` if there is no such grid, or a file cannot hold what is asked for.
void check(const Grid& grid, const FieldFiles& files, const FieldOptions& options) {
  validateGrid(grid);
  require(!files.distance.empty(), "a field needs a file to be written into");
  for (const SlabFile& file : slabFiles(files, options)) checkFieldFile(file.path, {.format = files.format});
  checkFieldFile(files.distance, {.format = files.format, .gridName = files.gridName, .half = files.half});
  const auto hasPlace = [&](bool isAsked, const Path& own, const char* what) {
    require(
        !isAsked || !own.empty() || files.keepsField || !isOneOf(files.distance, files, {".npy", ".nrrd"}),
        files.distance.string() + ": it holds one array; write the " + what +
            " into another file, or a "
            ".npz, .vti, .vdb or .nvdb");
  };
  hasPlace(options.triangle, files.triangle, "closest triangles");
  hasPlace(options.winding, files.winding, "winding numbers");
  hasPlace(options.confidence, files.confidence, "confidence");
}

}  // namespace

FieldOptions withArraysOf(const FieldFiles& files, FieldOptions options) {
  options.triangle |= !files.triangle.empty();
  options.winding |= !files.winding.empty();
  options.confidence |= !files.confidence.empty();
  return options;
}

std::vector<SlabFile> slabFiles(const FieldFiles& files, const FieldOptions& options) {
  std::vector<SlabFile> all{{.path = files.distance}};
  const bool holdsSeveral = isOneOf(files.distance, files, {".vti"});
  const auto add = [&](bool isAsked, const Path& path, FieldArray array) {
    if (isAsked && holdsSeveral) all.front().arrays.push_back(array);
    if (!path.empty()) all.push_back({.path = path, .arrays = {array}});
  };
  add(options.triangle, files.triangle, FieldArray::Triangle);
  add(options.winding, files.winding, FieldArray::Winding);
  add(options.confidence, files.confidence, FieldArray::Confidence);
  return all;
}

bool maySlabs(const MeshView& mesh, const FieldOptions& options, const FieldFiles& files,
              const MachineOptions& machine) {
  return !files.half && !files.keepsField && isOfSurface(mesh, options, machine) &&
         std::ranges::all_of(slabFiles(files, options), [&](const SlabFile& file) {
           return isOneOf(file.path, files, slabExtensions());
         });
}

RegionOptions regionOptions(const FieldOptions& options) {
  return {.band = options.band,
          .triangle = options.triangle,
          .winding = options.winding,
          .confidence = options.confidence};
}

FieldPlan planSlabs(const Grid& grid, const FieldOptions& options, const MachineOptions& machine,
                    size_t held) {
  constexpr size_t kManySamples = size_t{1} << 27;  // The speed gains no more from larger slabs.
  constexpr int kBest = cpu::kRegionBlock;
  // While a slab is made, the one before is written.
  const auto bytes = [&](int planes) {
    return regionBytes({grid.dims.x, grid.dims.y, 2 * planes}, regionOptions(options), machine);
  };
  auto planes = int(std::max<size_t>(kManySamples / (size_t(grid.dims.x) * size_t(grid.dims.y)), 1));
  if (planes > kBest) planes -= planes % kBest;
  planes = std::min(planes, grid.dims.z);
  // Leaves a quarter: more may be held when a later slab is checked.
  const size_t left = (std::max(mostMemory(machine.memoryLimit, held), held) - held) / 4 * 3;
  while (planes > 1 && bytes(planes) > left)
    planes = planes > kBest ? (planes - 1) / kBest * kBest : planes / 2;
  return {FieldForm::Slabs, planes, held + bytes(planes)};
}

FieldPlan planField(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                    const FieldFiles& files, const MachineOptions& machine, size_t held) {
  check(grid, files, options);
  if (isNarrowBand(mesh, grid, options, files, machine)) return {FieldForm::NarrowBand, grid.dims.z, 0};
  const size_t bytes = arrayCount(options) * sizeof(float) * samplesOf(grid);
  const bool fits = samplesOf(grid) < kNoTriangle && bytes <= mostMemory(machine.memoryLimit, held);
  if (!fits && maySlabs(mesh, options, files, machine)) return planSlabs(grid, options, machine);
  return {FieldForm::Whole, grid.dims.z, bytes};
}

FieldPlan planFile(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                   const FieldFiles& files, const MachineOptions& machine) {
  return planField(mesh, grid, withArraysOf(files, options), files, machine);
}

std::string keyOf(const MeshView& mesh, const FieldOptions& options) {
  const auto hash = [](const void* numbers, size_t bytes) {
    return std::to_string(std::hash<std::string_view>{}({static_cast<const char*>(numbers), bytes}));
  };
  std::string key = std::string(version().text) + ' ' +
                    hash(mesh.vertices, mesh.vertexCount * mesh.vertexStride) + ' ' +
                    hash(mesh.triangles, mesh.triangleCount * mesh.triangleStride) + ' ' +
                    std::string(name(options.orientation));
  constexpr int kAllDigits = 17;
  for (const double number : {mesh.origin.x, mesh.origin.y, mesh.origin.z, options.threshold, options.band})
    key += ' ' + numberText(number, kAllDigits);
  return key;
}

}  // namespace raymap
