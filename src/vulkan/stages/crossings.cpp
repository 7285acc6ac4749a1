// Krayer & Müller 2019, §3.5: the local intersection counts w_l.
//
// Paper: each cell intersects the triangles it holds, in eight passes by parity, so that no two write the
// same count. Here: each triangle is scanned over the lattice lines in its projection, as on the CPU. It adds
// to the counts by integer atomics, whose order does not matter. One invocation scans a triangle that covers
// few lines. Larger triangles are cut into runs of lines, so that one that covers the whole grid does not
// occupy a single invocation.

#include "vulkan/stages/crossings.h"

#include <raymap/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "base/ceil_div.h"
#include "base/text.h"
#include "shaders/crossings_reach_spv.h"
#include "shaders/crossings_runs_spv.h"
#include "shaders/crossings_triangles_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint64_t kMostElements = uint64_t{1} << 31;  // Shaders read indices as signed.

/// Invocations of a dispatch over runs. One takes about a tenth of an invocation of the exact distance.
constexpr uint32_t kRunsAtOnce = uint32_t{1} << 26;

/// Returns the number of runs of a triangle that covers the whole grid.
uint64_t runsOfLargest(const glm::u64vec3& dims) {
  const auto along = [](uint64_t u, uint64_t v) { return ceilDiv(u, uint64_t{kRunLines}) * v; };
  return along(dims.y, dims.z) + along(dims.x, dims.z) + along(dims.x, dims.y);
}

void checkSize(uint64_t elements, const char* what) {
  if (elements > kMostElements)
    throw Error(ErrorCode::Unsupported, std::to_string(elements) + " " + what +
                                            " are more than a device can number, 2^31; use a lower "
                                            "resolution, a smaller mesh or the CPU");
}

}  // namespace

CrossingsStage::CrossingsStage(Device& device, ScratchMemory* scratch)
    : reach_(device, shaders::kCrossingsReach, kCrossingsGroup),
      triangles_(device, shaders::kCrossingsTriangles, kCrossingsGroup),
      runs_(device, shaders::kCrossingsRuns, kCrossingsGroup),
      scan_(device),
      arguments_(device, "crossings arguments"),
      lines_{DeviceBuffer(device, "crossings along x", scratch),
             DeviceBuffer(device, "crossings along y", scratch),
             DeviceBuffer(device, "crossings along z", scratch)},
      crossed_(device, "crossed edges"),
      runCounts_(device, "crossings runs"),
      status_(device, "crossings status") {
  status_.resize<CrossingsStatus>(1);
}

void CrossingsStage::reserve(const glm::ivec3& dims, uint64_t triangleCount, bool keepsCrossed) {
  checkSize(3 * triangleCount, "corners of triangles");
  std::array<uint64_t, 3> edges{};
  for (int axis = 0; axis < 3; ++axis) {
    glm::u64vec3 size(dims);
    ++size[axis];
    edges[static_cast<size_t>(axis)] = size.x * size.y * size.z;
    checkSize(edges[static_cast<size_t>(axis)], "lattice edges along an axis");
  }
  dims_ = dims;
  for (size_t axis = 0; axis < 3; ++axis) lines_[axis].resize<int32_t>(edges[axis]);
  crossedWords_ = static_cast<uint32_t>(std::ranges::max(edges) / 32 + 1);
  crossed_.resize<uint32_t>(keepsCrossed ? 3 * uint64_t{crossedWords_} : 0);
  runCounts_.resize<uint32_t>(triangleCount + 1);
  scan_.reserve(static_cast<uint32_t>(triangleCount));
  const uint64_t mostRuns = std::min<uint64_t>(triangleCount * runsOfLargest(dims), kMostRuns);
  arguments_.reserve({.most = static_cast<uint32_t>(mostRuns),
                      .itemsPerGroup = kCrossingsGroup,
                      .mostGroups = kRunsAtOnce / kCrossingsGroup});
}

void CrossingsStage::record(Commands& commands, const DeviceMesh& mesh) {
  const CrossingsPush push{.vertices = mesh.vertices,
                           .triangles = mesh.triangles,
                           .lines = {line(0).address(), line(1).address(), line(2).address()},
                           .runs = runCounts_.address(),
                           .status = status_.address(),
                           .crossed = crossed_.bytes() > 0 ? crossed_.address() : 0,
                           .dims = glm::uvec3(dims_),
                           .triangleCount = mesh.triangleCount,
                           .crossedWords = crossedWords_};
  commands.concurrent([&] {
    commands.fill(status_, 0);
    for (const DeviceBuffer& axis : lines_) commands.fill(axis, 0);
    if (crossed_.bytes() > 0) commands.fill(crossed_, 0);
  });
  commands.dispatch(reach_, push, mesh.triangleCount);
  commands.dispatch(triangles_, push, mesh.triangleCount);
  scan_.record(commands, push.runs, push.runs, mesh.triangleCount);
  arguments_.record(commands, push.status + offsetof(CrossingsStatus, runs));
  arguments_.dispatch(commands, runs_, push);
}

LatticeLines CrossingsStage::lines() const {
  return {dims_, {line(0).address(), line(1).address(), line(2).address()}};
}

std::optional<Error> failureOf(const CrossingsStatus& status) {
  if (status.tooFarCorner != 0) {
    const uint32_t corner = ~status.tooFarCorner;
    return Error(ErrorCode::Input,
                 "corner " + std::to_string(corner % 3) + " of triangle " + std::to_string(corner / 3) +
                     " lies too far from the grid's first sample: the furthest one is " +
                     numberText(std::bit_cast<float>(status.reach)) +
                     " cells away, the sign needs less than 2^40; use a coarser grid or remove the vertex");
  }
  const uint64_t runs = (uint64_t{status.runsHigh} << 32) | status.runs;
  if (runs > kMostRuns)
    return Error(ErrorCode::Unsupported, "the large triangles cover " + std::to_string(runs) +
                                             " runs of lattice lines, the device can number 2^31; use a "
                                             "lower resolution or the CPU");
  return std::nullopt;
}

}  // namespace raymap::vulkan
