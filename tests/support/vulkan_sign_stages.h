#pragma once

// Runs the stages that lead to the sign on a device and converts their results to the CPU's form and back.

#include "vulkan/stages/crossings.h"
#include "vulkan/stages/ray_map.h"
#include "vulkan/stages/winding_rays.h"
#include "vulkan_rays.h"

namespace raymap::vulkan {

/// A number for each lattice edge along each axis, as on the device (vulkan/stages/crossings.h).
using EdgeCounts = std::array<std::vector<int32_t>, 3>;

/// Calls `work(line, edge, index)` for all edges of an axis: `line` as the CPU numbers it.
template <class Work>
void forEachEdge(glm::ivec3 dims, int axis, Work&& work) {
  const LineAxes across(axis);
  const int nu = dims[across.u];
  ++dims[axis];
  size_t index = 0;
  for (glm::ivec3 s(0); s.z < dims.z; ++s.z)
    for (s.y = 0; s.y < dims.y; ++s.y)
      for (s.x = 0; s.x < dims.x; ++s.x)
        work(size_t(s[across.v]) * size_t(nu) + size_t(s[across.u]), s[axis], index++);
}

inline EdgeCounts edgeCounts(const cpu::Crossings& crossings, const glm::ivec3& dims) {
  EdgeCounts counts;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisCrossings& from = crossings[size_t(axis)];
    forEachEdge(dims, axis, [&](size_t line, int edge, size_t) {
      int32_t& count = counts[size_t(axis)].emplace_back(0);
      for (uint64_t e = from.starts[line]; e < from.starts[line + 1]; ++e)
        if (from.entries[e].index + 1 == edge) count = from.entries[e].signedCount;
    });
  }
  return counts;
}

inline EdgeCounts edgeCounts(const cpu::RayMap& map) {
  return {suffixSums(map, 0), suffixSums(map, 1), suffixSums(map, 2)};
}

/// Returns the crossings in the CPU's form, without unsigned counts and without edges whose signed crossings
/// cancel.
inline cpu::Crossings toCrossings(const EdgeCounts& counts, const glm::ivec3& dims) {
  cpu::Crossings crossings;
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes across(axis);
    std::vector<std::vector<Crossing>> lines(size_t(dims[across.u]) * size_t(dims[across.v]));
    forEachEdge(dims, axis, [&](size_t line, int edge, size_t index) {
      const int32_t count = counts[size_t(axis)].at(index);
      if (count != 0) lines[line].push_back({.index = edge - 1, .signedCount = count});
    });
    std::vector<Crossing> entries;
    AxisCrossings& to = crossings[size_t(axis)];
    to.starts.resizeUninitialized(lines.size() + 1);
    for (size_t line = 0; line < lines.size(); ++line) {
      to.starts[line] = entries.size();
      entries.insert(entries.end(), lines[line].begin(), lines[line].end());
    }
    to.starts[lines.size()] = entries.size();
    to.entries.resizeUninitialized(entries.size());
    std::copy(entries.begin(), entries.end(), to.entries.begin());
  }
  return crossings;
}

/// Returns the ray map in the CPU's form.
inline cpu::RayMap toRayMap(EdgeCounts rays, const glm::ivec3& dims) {
  const EdgeCounts sums = rays;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t stride = axis == 0 ? 1 : axis == 1 ? size_t(dims.x) : size_t(dims.x) * size_t(dims.y);
    forEachEdge(dims, axis, [&](size_t, int edge, size_t index) {
      if (edge < dims[axis]) rays[size_t(axis)][index] -= sums[size_t(axis)].at(index + stride);
    });
  }
  cpu::RayMap map;
  buildRayMap(dims, toCrossings(rays, dims), map);
  return map;
}

struct SignResult {
  EdgeCounts crossings, rays;
  std::vector<float> winding;
  uint32_t doubtful = 0;
  bool operator==(const SignResult&) const = default;
};

/// Runs the stages on the device of the tests. The stage objects are kept from one mesh to the next.
class SignStages : public VulkanTest {
 public:
  /// Runs the first stage alone. Throws the error that it reports.
  static EdgeCounts countCrossings(const CellMesh& mesh) {
    const DeviceBuffer vertices =
        upload(std::vector<glm::vec3>(mesh.vertices.begin(), mesh.vertices.end()), "vertices");
    const DeviceBuffer triangles =
        upload(std::vector<glm::uvec3>(mesh.triangles.begin(), mesh.triangles.end()), "triangles");
    stages().crossings.reserve(mesh.dims, mesh.triangles.size());
    run([&](Commands& commands) {
      stages().crossings.record(commands, {.vertices = vertices.address(),
                                           .triangles = triangles.address(),
                                           .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
                                           .triangleCount = static_cast<uint32_t>(mesh.triangles.size())});
    });
    if (const auto error = failureOf(download<CrossingsStatus>(stages().crossings.status()).at(0)))
      throw *error;
    return edges();
  }

  static SignResult compute(const CellMesh& mesh, SignMode mode = SignMode::Rays) {
    SignResult result{.crossings = countCrossings(mesh)};
    const LatticeLines lines = stages().crossings.lines();
    DeviceBuffer winding(device(), "winding");
    winding.resize<float>(size_t(mesh.dims.x) * size_t(mesh.dims.y) * size_t(mesh.dims.z));
    run([&](Commands& commands) {
      stages().rayMap.record(commands, lines);
      stages().windingRays.record(commands, lines, mode, winding.address());
    });
    result.rays = edges();
    result.winding = download<float>(winding);
    result.doubtful = download<uint32_t>(stages().windingRays.doubtful()).at(0);
    return result;
  }

 private:
  struct Stages {
    CrossingsStage crossings{device()};
    RayMapStage rayMap{device()};
    WindingRaysStage windingRays{device()};
  };
  static Stages& stages() {
    shared();  // The device is made before the stages, so it is destroyed after them.
    static Stages stages;
    return stages;
  }
  static EdgeCounts edges() {
    const CrossingsStage& crossings = stages().crossings;
    return {download<int32_t>(crossings.line(0)), download<int32_t>(crossings.line(1)),
            download<int32_t>(crossings.line(2))};
  }
};

}  // namespace raymap::vulkan
