// Krayer & Müller 2019, §3.1.
//
// Paper: the rasterizer distributes the work. Here: a prefix sum over the number of cell rows in each
// triangle's bounds numbers all rows. Each invocation finds its row's triangle in the sums. A second kernel
// decides, with doubles in software, the rows for which floats do not suffice.

#include "vulkan/stages/cell_runs.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

#include "shaders/cell_runs_exact_spv.h"
#include "shaders/cell_runs_rows_spv.h"
#include "shaders/cell_runs_spv.h"

namespace raymap::vulkan {

namespace {
constexpr uint32_t kMostRows = uint32_t{1} << 30;
}

CellRunsStage::CellRunsStage(Device& device)
    : countRows_(device, shaders::kCellRunsRows, kRunsGroup),
      findRuns_(device, shaders::kCellRuns, kRunsGroup),
      findUnknown_(device, shaders::kCellRunsExact, kRunsGroup),
      scan_(device),
      arguments_(device, "cell runs arguments", 2),
      rowStarts_(device, "cell rows"),
      runTriangles_(device, "cell runs' triangles"),
      runCells_(device, "cell runs' cells"),
      runStarts_(device, "cell runs' starts"),
      unknown_(device, "cell rows to find exactly"),
      unknownCount_(device, "count of cell rows to find exactly"),
      totals_(device, "cell runs' totals") {}

void CellRunsStage::reserve(const CellLattice& cells, uint32_t triangles, uint64_t rows) {
  // In fine meshes a triangle touches about two rows. The minimum is negligible work.
  constexpr uint64_t kRowsPerTriangle = 3, kFewRows = uint64_t{1} << 16;
  if (rows > kMostRows)
    throw Error(ErrorCode::Memory, "the triangles touch " + std::to_string(rows) +
                                       " rows of cells, the device can number " + std::to_string(kMostRows) +
                                       "; use a lower resolution, exact distance or the CPU");
  const uint64_t wanted = std::max(rows + rows / 8, kRowsPerTriangle * triangles + kFewRows);
  cells_ = cells;
  for (auto* kernel : {&countRows_, &findRuns_, &findUnknown_}) kernel->choose(isOfSamples(cells));
  mostTriangles_ = triangles;
  rowStarts_.resize<uint32_t>(uint64_t{triangles} + 1);
  totals_.resize<CellRunsTotals>(1);
  unknownCount_.resize<uint32_t>(1);
  reserveRows(std::max(mostRows_, static_cast<uint32_t>(std::min<uint64_t>(kMostRows, wanted))));
}

void CellRunsStage::reserveRows(uint32_t rows) {
  scan_.reserve(std::max(mostTriangles_, rows));
  runTriangles_.resize<uint32_t>(rows);
  runCells_.resize<uint32_t>(rows);
  unknown_.resize<uint32_t>(rows);
  runStarts_.resize<uint32_t>(uint64_t{rows} + 1);
  mostRows_ = rows;
}

void CellRunsStage::record(Commands& commands, const DeviceMesh& mesh) {
  const CellRunsPush push{.vertices = mesh.vertices,
                          .triangles = mesh.triangles,
                          .rowStarts = rowStarts_.address(),
                          .runTriangles = runTriangles_.address(),
                          .runCells = runCells_.address(),
                          .runSizes = runStarts_.address(),
                          .totals = totals_.address(),
                          .unknown = unknown_.address(),
                          .unknownCount = unknownCount_.address(),
                          .cells = latticeOf(cells_),
                          .triangleCount = mesh.triangleCount,
                          .mostRows = mostRows_};
  commands.concurrent([&] {
    commands.fill(totals_, 0);
    commands.fill(unknownCount_, 0);
  });
  commands.dispatch(*countRows_, push, mesh.triangleCount);
  scan_.record(commands, rowStarts_.address(), rowStarts_.address(), {.most = mesh.triangleCount});
  const Count rows{.most = mostRows_, .address = totals_.address()};
  arguments_.record(commands, 0, {.count = rows, .itemsPerGroup = kRunsGroup, .fewestGroups = 1});
  arguments_.dispatch(commands, *findRuns_, push, 0);
  const Count unknown{.most = mostRows_, .address = unknownCount_.address()};
  arguments_.record(commands, 1, {.count = unknown, .itemsPerGroup = kRunsGroup});
  arguments_.dispatch(commands, *findUnknown_, push, 1);
  scan_.record(commands, runStarts_.address(), runStarts_.address(), rows);
}

}  // namespace raymap::vulkan
