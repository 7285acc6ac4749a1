#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/generate.h>

#include <algorithm>

#include "api/devices.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "cpu/run_on_cpu.h"
#include "mesh/packed_mesh.h"
#include "method/check_options.h"
#include "method/far_field.h"
#include "method/thickness.h"

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

void warnOfMisfit(const Stats& stats, const WarningCallback& warn) {
  if (warn && !stats.orientationFits)
    warn({WarningCode::OrientationMisfit,
          "no directions of the faces fit the crossings, misfit " + numberText(stats.misfit, 3) +
              ", so signs may be wrong; find out what is wrong with the mesh, and mend it",
          {.share = stats.misfit}});
}

/// Returns whether the cells of the grid hold the box.
bool holds(const Grid& grid, const Box& box) {
  constexpr double kHalfCell = 0.5 + 1e-6;  // A box may be what the grid was fitted to.
  const glm::dvec3 low = grid.position(glm::dvec3(-kHalfCell));
  const glm::dvec3 high = grid.position(glm::dvec3(grid.dims - 1) + kHalfCell);
  return glm::all(glm::lessThanEqual(low, box.min)) && glm::all(glm::lessThanEqual(box.max, high));
}

bool hasInside(const Field& field, const FieldOptions& options) {
  return std::ranges::any_of(field.distance, [&](float d) { return options.invert ? d > 0.0f : d < 0.0f; });
}

/// Warns if a mesh that lies in the grid has no sample inside, though a sign was asked for.
void warnOfNothingInside(const PackedMesh& mesh, const Field& field, const FieldOptions& options,
                         const MachineOptions& machine) {
  if (!machine.warn || options.sign == SignMode::None || options.thickness > 0.0) return;
  if (hasInside(field, options) || !holds(field.grid, bounds(mesh))) return;
  const Diagnostics found = diagnose(mesh, {.brief = true}, {.threads = machine.threads});
  const double spacing = field.grid.spacing;
  const std::string begin = "no sample is inside, because ";
  // A plate has half of its thickness as volume over area.
  const double finer = found.balanced ? std::abs(found.signedVolume) / found.area : 0.0;
  constexpr double kSheet = 0.03;  // Share of the spacing; below it, samples would be too many.
  if (finer > kSheet * spacing && finer < spacing) {
    const double voxelSize = roundDown(finer);
    machine.warn({WarningCode::NothingInside,
                  begin + "the mesh is thinner than the spacing " + numberText(spacing, 3) +
                      "; use a spacing of " + numberText(voxelSize, 3),
                  {.voxelSize = voxelSize}});
    return;
  }
  const double thickness = 2.0 * spacing;
  machine.warn({WarningCode::NothingInside,
                begin + "the faces enclose nothing at the spacing " + numberText(spacing, 3) +
                    "; make a solid around its surface, with a thickness of " + numberText(thickness, 3) +
                    ", or use a smaller spacing",
                {.length = thickness}});
}

}  // namespace

struct Generator::Impl {
  cpu::Backend cpuBackend;
  ChosenDevice device;
  MeshPacker packer;

  PackedMesh pack(const MeshView& view, size_t memoryLimit) {
    if (view.triangleCount == 0)
      throw Error(ErrorCode::Input,
                  "the mesh has no triangles; allow empty meshes for a field that is far everywhere");
    if (memoryLimit > 0) checkFieldMemory(MeshPacker::bytesNeeded(view), memoryLimit);
    const PackedMesh mesh = packer.pack(view);
    validate(mesh);
    return mesh;
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
    if (view.triangleCount == 0 && asked.allowEmpty) {
      const size_t arrays = size_t{1} + asked.triangle + asked.winding + asked.confidence;
      stats.bytes = arrays * grid.sampleCount() * sizeof(float);
      if (machine.memoryLimit > 0) checkFieldMemory(stats.bytes, machine.memoryLimit);
      fillFar(grid, asked, field);
      stats.milliseconds = stopwatch.milliseconds();
      return stats;
    }
    const FieldOptions options = asked.thickness > 0.0 ? withoutThickness(asked, grid) : asked;
    const PackedMesh mesh = impl_->pack(view, machine.memoryLimit);
    const auto onGpu = [&](GpuDevice& gpu, size_t number) {
      Progress progress(machine.progress);
      withThreads(machine.threads, [&] {
        gpu.generate({mesh, grid, options, progress, field, machine}, stats);
      });
      stats.device = "vulkan:" + std::to_string(number);
    };
    if (!impl_->device.run(machine, onGpu)) {
      Progress progress(machine.progress);
      stats = cpu::runOnCpu(impl_->cpuBackend, {mesh, grid, options, progress, field, machine},
                            impl_->packer.bytes());
    }
    if (asked.thickness > 0.0) thicken(asked, machine.threads, field);
    field.surfaceBounds = surfaceBounds(mesh, grid, asked, stats);
    warnOfMisfit(stats, machine.warn);
    warnOfNothingInside(mesh, field, asked, machine);
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
