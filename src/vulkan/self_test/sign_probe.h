#pragma once

// Runs the stages that lead to the sign on a device, and converts their results to the CPU's form and back.

#include <array>

#include "cpu/sign/crossings.h"
#include "cpu/sign/ray_map.h"
#include "method/cell_lattice.h"
#include "vulkan/self_test/probe.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/ray_map.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// Returns r along an axis, as the device holds it (vulkan/stages/ray_map.glsl).
inline std::vector<int32_t> suffixSums(const cpu::RayMap& map, int axis) {
  CellLattice edges{map.dims};
  ++edges.dims[axis];
  std::vector<int32_t> sums;
  for (size_t e = 0; e < edges.count(); ++e) {
    glm::ivec3 before = edges.cell(e);
    --before[axis];
    sums.push_back(map.ray(axis, before));
  }
  return sums;
}

/// The CPU's ray map on the device.
class UploadedRays {
 public:
  UploadedRays(const Probe& probe, const cpu::RayMap& map) {
    for (int axis = 0; axis < 3; ++axis) sums_[size_t(axis)] = probe.upload(suffixSums(map, axis), "rays");
  }
  std::array<VkDeviceAddress, 3> addresses() const {
    return {sums_[0].address(), sums_[1].address(), sums_[2].address()};
  }

 private:
  std::array<DeviceBuffer, 3> sums_;
};

/// Returns the winding numbers that a stage makes of others, and checks that it makes the same again.
template <class Values, class Record>
std::vector<float> windingAfter(const Probe& probe, const cpu::RayMap& map, const Values& before,
                                uint32_t doubtful, Record&& record) {
  const UploadedRays rays(probe, map);
  const DeviceBuffer count = probe.upload(std::vector{doubtful}, "doubtful");
  std::array<std::vector<float>, 2> after;
  for (std::vector<float>& winding : after) {
    const DeviceBuffer values = probe.upload(before, "winding");
    probe.run([&](Commands& commands) {
      record(commands, WindingFields{rays.addresses(), values.address(), count.address()});
    });
    winding = probe.download<float>(values);
  }
  requireEqual("winding numbers the second time", after[1], after[0]);
  return after[0];
}

/// A number for each lattice edge along each axis, as on the device (vulkan/stages/crossings.h).
using EdgeCounts = std::array<std::vector<int32_t>, 3>;

inline EdgeCounts edgeCounts(const cpu::Crossings& crossings, const glm::ivec3& dims) {
  EdgeCounts counts;
  for (int axis = 0; axis < 3; ++axis) {
    const cpu::AxisCrossings& from = crossings[size_t(axis)];
    const LineAxes across(axis);
    CellLattice edges{dims};
    ++edges.dims[axis];
    counts[size_t(axis)].resize(edges.count());
    for (size_t line = 0; line + 1 < from.starts.size(); ++line)
      for (uint64_t e = from.starts[line]; e < from.starts[line + 1]; ++e) {
        glm::ivec3 at(from.entries[e].index + 1);
        at[across.u] = int(line) % dims[across.u];
        at[across.v] = int(line) / dims[across.u];
        counts[size_t(axis)][edges.index(at)] = from.entries[e].signedCount;
      }
  }
  return counts;
}

inline EdgeCounts edgeCounts(const cpu::RayMap& map) {
  return {suffixSums(map, 0), suffixSums(map, 1), suffixSums(map, 2)};
}

struct SignResult {
  EdgeCounts crossings, rays;
  std::vector<float> winding;
  uint32_t doubtful = 0;
  bool operator==(const SignResult&) const = default;
};

/// Runs the stages. The stage objects are kept from one mesh to the next.
class SignProbe : public Probe {
 public:
  using Probe::Probe;

  /// Runs the first stage alone. Throws the error that it reports.
  EdgeCounts countCrossings(const CellMesh& mesh) {
    const UploadedMesh uploaded = upload(mesh);
    crossings_.reserve(mesh.dims, mesh.triangles.size());
    run([&](Commands& commands) { crossings_.record(commands, uploaded.addresses()); });
    if (const auto error = failureOf(download<CrossingsStatus>(crossings_.status()).at(0))) throw *error;
    return edges();
  }

  SignResult compute(const CellMesh& mesh, SignMode mode = SignMode::Rays) {
    SignResult result{.crossings = countCrossings(mesh)};
    const LatticeLines lines = crossings_.lines();
    const DeviceBuffer winding = room<float>(CellLattice{mesh.dims}.count(), "winding");
    run([&](Commands& commands) {
      rayMap_.record(commands, lines);
      windingRays_.record(commands, lines, mode, winding.address());
    });
    result.rays = edges();
    result.winding = download<float>(winding);
    result.doubtful = download<uint32_t>(windingRays_.doubtful()).at(0);
    return result;
  }

 private:
  EdgeCounts edges() const {
    return {download<int32_t>(crossings_.line(0)), download<int32_t>(crossings_.line(1)),
            download<int32_t>(crossings_.line(2))};
  }

  CrossingsStage crossings_{device()};
  RayMapStage rayMap_{device()};
  WindingRaysStage windingRays_{device()};
};

}  // namespace raymap::vulkan
