#include <raymap/error.h>
#include <raymap/generate.h>

#include <algorithm>

#include "api/devices.h"
#include "api/field_warnings.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/require.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "cpu/backend.h"
#include "mesh/model.h"
#include "method/check_options.h"
#include "method/far_field.h"
#include "method/plate.h"

namespace raymap {

namespace {

/// Returns the bounds of the surface that a field's distances lead to; empty for a field inside out, which
/// has its solid on the other side.
Box surfaceBounds(const PackedMesh& mesh, const Grid& grid, const FieldOptions& options, const Stats& stats) {
  if (options.invert) return {};
  Box box = bounds(mesh);
  box.min -= 0.5 * options.thickness;
  box.max += 0.5 * options.thickness;
  if (stats.patchTriangles > 0) {  // The surface that closes holes lies in the grid.
    box.min = glm::min(box.min, grid.origin);
    box.max = glm::max(box.max, grid.position(grid.dims - 1));
  }
  return box;
}

bool hasInside(const Field& field, const FieldOptions& options) {
  return std::ranges::any_of(field.distance, [&](float d) { return options.invert ? d > 0.0f : d < 0.0f; });
}

}  // namespace

struct Generator::Impl {
  cpu::Backend cpuBackend;
  ChosenDevice device;
  Model model;

  const Model& pack(const MeshView& view, size_t memoryLimit) {
    if (view.triangleCount == 0)
      throw Error(ErrorCode::Input,
                  "the mesh has no triangles; allow empty meshes for a field that is far everywhere");
    if (memoryLimit > 0) checkFieldMemory(Model::bytesNeeded(view), memoryLimit);
    model.pack(view);
    validate(model);
    return model;
  }
};

Generator::Generator() : impl_(std::make_unique<Impl>()) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

Stats Generator::generate(const MeshView& view, const Grid& grid, const FieldOptions& asked, Field& field,
                          const MachineOptions& machine) {
  const Stopwatch stopwatch;
  Stats stats;
  try {
    checkOptions(grid, asked);
    field.narrow.reset();
    if (view.triangleCount == 0 && asked.allowEmpty) {
      const size_t arrays = size_t{1} + asked.triangle + asked.winding + asked.confidence;
      stats.bytes = arrays * grid.sampleCount() * sizeof(float);
      if (machine.memoryLimit > 0) checkFieldMemory(stats.bytes, machine.memoryLimit);
      fillFar(grid, asked, field);
      stats.milliseconds = stopwatch.milliseconds();
      return stats;
    }
    const FieldOptions options = asked.thickness > 0.0 ? withoutThickness(asked, grid) : asked;
    const Model& mesh = notMoved(impl_).pack(view, machine.memoryLimit);
    const auto onGpu = [&](GpuDevice& gpu, size_t number) {
      Progress progress(machine.progress);
      withThreads(machine.threads, [&] {
        gpu.generate({mesh, grid, options, progress, field, machine}, stats);
      });
      stats.device = "vulkan:" + std::to_string(number);
    };
    if (!notMoved(impl_).device.run(machine, onGpu)) {
      Progress progress(machine.progress);
      stats = notMoved(impl_).cpuBackend.run({mesh, grid, options, progress, field, machine});
    }
    if (asked.thickness > 0.0) thicken(asked, machine.threads, field);
    field.surfaceBounds = surfaceBounds(mesh, grid, asked, stats);
    warnOfMisfit(stats, machine.warn);
    warnOfInvertedParts(stats, machine.warn);
    if (asked.sign != SignMode::None && asked.thickness == 0.0 && !hasInside(field, asked))
      warnOfNothingInside(mesh, field.grid, machine);
  } catch (...) {
    field = {};
    throw;
  }
  stats.milliseconds = stopwatch.milliseconds();
  return stats;
}

Generated Generator::generate(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                              const MachineOptions& machine) {
  Generated result;
  result.stats = generate(mesh, grid, options, result.field, machine);
  return result;
}

Generated generate(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                   const MachineOptions& machine) {
  return Generator().generate(mesh, grid, options, machine);
}

}  // namespace raymap
