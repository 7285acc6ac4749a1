#include <raymap/error.h>
#include <raymap/surface.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "base/require.h"
#include "base/stopwatch.h"
#include "io/file_format.h"
#include "make/plan.h"

namespace raymap {

namespace {

/// A field to make by a surface.
struct Job {
  const Grid& grid;
  const FieldOptions& options;  ///< With the arrays that the files ask for.
  const FieldFiles& files;
  const MachineOptions& machine;
};

void tell(const Job& job, const FieldPlan& plan) {
  if (job.files.planned) job.files.planned(plan);
}

/// Does a stage's work, and notes its time.
template <class Work>
void runStage(Stats& stats, const char* name, Work&& work) {
  const Stopwatch stopwatch;
  work();
  stats.stages.push_back({name, stopwatch.milliseconds()});
  stats.milliseconds += stats.stages.back().milliseconds;
}

/// Takes the mesh if there is one to take.
Field makeBand(const Job& job, const MeshView& mesh, Mesh* taken, FileReport& report) {
  const FieldOptions& options = job.options;
  const SurfaceOptions asked{.orientation = options.orientation,
                             .threshold = options.threshold,
                             .compact = isCompactBetter(job.grid, mesh.triangleCount)};
  tell(job, report.plan);
  const Surface surface =
      taken ? Surface(std::move(*taken), asked, job.machine) : Surface(mesh, asked, job.machine);
  report.stats = surface.stats();
  Field band;
  runStage(report.stats, "narrow_band", [&] {
    const double inside = job.files.fullInside ? std::numeric_limits<double>::infinity() : options.band;
    band = surface.generateBand(job.grid, {.outside = options.band, .inside = inside}, job.machine);
  });
  report.stats.bytes = std::max(report.stats.bytes, surface.bytes() + band.bytes());
  return band;
}

/// Makes a field that does not fit into memory, and writes it slab by slab.
void makeSlabs(const Job& job, const MeshView& mesh, FileReport& report) {
  const Grid& grid = job.grid;
  const FieldOptions& options = job.options;
  const FieldFiles& files = job.files;
  const MachineOptions& machine = job.machine;
  const Surface surface(mesh, {.orientation = options.orientation, .threshold = options.threshold}, machine);
  report.stats = surface.stats();
  report.plan = planSlabs(grid, options, machine, surface.bytes());
  bool isFirst = true;
  const auto slab = [&](int begin, int end) {
    if (isFirst) tell(job, report.plan);
    MachineOptions one = machine;
    if (!std::exchange(isFirst, false)) one.warn = {};  // Once is enough.
    if (machine.progress)
      one.progress = [&](std::string_view stage, double done) {
        return machine.progress(stage, (double(begin) + done * double(end - begin)) / double(grid.dims.z));
      };
    return surface.generateRegion(grid, {{0, 0, begin}, {grid.dims.x, grid.dims.y, end - begin}},
                                  regionOptions(options), one);
  };
  const Field about{
      .grid = grid, .clampDistance = options.band * grid.spacing, .surfaceBounds = bounds(surface.mesh())};
  const SlabOptions slabs{.planes = report.plan.planes,
                          .format = files.format,
                          .key = keyOf(surface.mesh(), options),
                          .warn = machine.warn};
  runStage(report.stats, "slabs", [&] { writeFieldInSlabs(slabFiles(files, options), about, slab, slabs); });
  report.stats.bytes = std::max(report.stats.bytes, report.plan.bytes);
}

}  // namespace

FileReport FileGenerator::run(const MeshView& mesh, Mesh* taken, const Grid& grid, const FieldOptions& asked,
                              const MachineOptions& machine) {
  const FieldOptions options = withArraysOf(files_, asked);
  const Job job{grid, options, files_, machine};
  form_ = FieldForm::Slabs;  // Nothing to write, if this fails.
  FileReport report{.plan = planField(mesh, grid, options, files_, machine, field_.bytes())};
  const FieldForm form = report.plan.form;
  require(
      !files_.fullInside || form == FieldForm::NarrowBand,
      "the whole inside is kept in a narrow band alone: with a band, a .vdb or .nvdb, exact distances and "
      "the sign 'harmonic', on the CPU, and without closed holes, inversion, thickness and further arrays");
  if (form == FieldForm::Whole) {
    try {
      tell(job, report.plan);
      report.stats = generator_.generate(mesh, grid, options, field_, machine);
      form_ = form;
      return report;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Memory || !maySlabs(mesh, options, files_, machine)) throw;
    }
  }
  field_ = {};
  if (form == FieldForm::NarrowBand) {
    field_ = makeBand(job, mesh, taken, report);
    form_ = form;
  } else {
    generator_ = {};  // Its memory goes to the slabs.
    makeSlabs(job, mesh, report);
  }
  return report;
}

FileReport FileGenerator::make(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                               const FieldFiles& files, const MachineOptions& machine) {
  files_ = files;
  return run(mesh, nullptr, grid, options, machine);
}

FileReport FileGenerator::make(Mesh&& mesh, const Grid& grid, const FieldOptions& options,
                               const FieldFiles& files, const MachineOptions& machine) {
  files_ = files;
  return run(mesh, &mesh, grid, options, machine);
}

void FileGenerator::write() const {
  if (form_ == FieldForm::Slabs) return;
  FieldWriteOptions how{.format = files_.format, .gridName = files_.gridName, .half = files_.half};
  writeField(files_.distance, field_, how);
  how.gridName = {};
  const auto writeAlso = [&](const std::filesystem::path& path, FieldArray array) {
    if (path.empty()) return;
    how.array = array;
    how.half = files_.half && canHalve(path, files_.format);
    writeField(path, field_, how);
  };
  writeAlso(files_.triangle, FieldArray::Triangle);
  writeAlso(files_.winding, FieldArray::Winding);
  writeAlso(files_.confidence, FieldArray::Confidence);
}

FileReport generateFile(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                        const FieldFiles& files, const MachineOptions& machine) {
  FileGenerator generator;
  FileReport report = generator.make(mesh, grid, options, files, machine);
  generator.write();
  return report;
}

}  // namespace raymap
