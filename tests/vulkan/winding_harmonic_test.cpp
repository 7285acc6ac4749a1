#include "vulkan/stages/winding_harmonic.h"

#include <cmath>

#include "broken_meshes.h"
#include "counters/work_counter.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingHarmonic : public VulkanTest {};

TEST_F(VulkanWindingHarmonic, MatchesTheCpu) {
  WindingHarmonicStage harmonic(device());
  for (const Mesh& mesh : {withoutCap(shapes::sphere(1.0, 3), 0.6), shapes::soup(300, 4)})
    for (const glm::ivec3 dims : {glm::ivec3(33, 20, 41), glm::ivec3(48, 48, 48), glm::ivec3(1, 9, 30)}) {
      const Box box = bounds(mesh);
      const double spacing = 1.2 * std::max({box.size().x, box.size().y, box.size().z}) / 40.0;
      const Grid grid{
          .dims = dims, .origin = box.centre() - 0.5 * spacing * glm::dvec3(dims), .spacing = spacing};
      compareHarmonic(kept<Probe>(), harmonic, rayMapOf(mesh, grid));
    }
}

TEST_F(VulkanWindingHarmonic, SolvesNothingWhereAllRaysAgree) {
  WindingHarmonicStage harmonic(device());
  const Mesh mesh = shapes::sphere(1.0, 2);
  const RayMap map = rayMapOf(mesh, fitGrid(mesh, {.resolution = 20}));
  harmonic.reserve(map.dims);
  const std::vector<float> before(CellLattice{map.dims}.count(), 7.0f);
  EXPECT_EQ(windingAfter(kept<Probe>(), map, before, 0,
                         [&](Commands& commands, const auto& fields) { harmonic.record(commands, fields); }),
            before);
}

/// Each step costs an animation some microseconds, even behind a shut gate.
TEST_F(VulkanWindingHarmonic, TakesFewSteps) {
  WorkCounter counter(Measured::Time);
  Device counted{DeviceOptions{}};
  counter.start(counted);
  {
    const Probe probe(counted);
    const DeviceBuffer doubtful = probe.upload(std::vector<uint32_t>{0});
    WindingHarmonicStage harmonic(counted);
    for (const auto& [samples, steps] : {std::pair{32, 10U}, {64, 23U}, {128, 41U}}) {
      harmonic.reserve(glm::ivec3(samples));
      counter.clear();
      probe.run([&](Commands& commands) { harmonic.record(commands, {.doubtful = doubtful.address()}); });
      EXPECT_EQ(counter.commands().back().step + 1 - counter.commands().front().step, steps) << samples;
    }
  }
  counter.stop();
}

}  // namespace
}  // namespace raymap::vulkan
