#pragma once

#include "sign_scene.h"
#include "vulkan/self_test/sign_probe.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// Returns the crossings in the CPU's form, without unsigned counts and without edges whose signed crossings
/// cancel.
inline cpu::Crossings toCrossings(const EdgeCounts& counts, const glm::ivec3& dims) {
  cpu::Crossings crossings;
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes across(axis);
    std::vector<std::vector<cpu::Crossing>> lines(size_t(dims[across.u]) * size_t(dims[across.v]));
    forEachEdge(dims, axis, [&](size_t line, int edge, size_t index) {
      const int32_t count = counts[size_t(axis)].at(index);
      if (count != 0) lines[line].push_back({.index = edge - 1, .signedCount = count});
    });
    std::vector<cpu::Crossing> entries;
    cpu::AxisCrossings& to = crossings[size_t(axis)];
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

/// Runs the stages that lead to the sign on the device of the tests.
class SignStages : public VulkanTest {
 public:
  static SignProbe& probe() {
    shared();  // The device is made before the stages, so it is destroyed after them.
    static SignProbe probe(device());
    return probe;
  }
};

}  // namespace raymap::vulkan
