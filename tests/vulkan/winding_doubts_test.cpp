#include "vulkan/stages/winding_doubts.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "cpu/sign/crossings_lines.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/sign_probe.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingDoubts : public VulkanTest {};

TEST_F(VulkanWindingDoubts, FindTheLargestChangeThatTheCpuFinds) {
  WindingDoubtsStage stage(device());
  // The last grid has two groups, and more samples than whole groups.
  for (const glm::ivec3 dims : {glm::ivec3(1, 9, 7), glm::ivec3(13, 11, 12), glm::ivec3(31, 17, 23)}) {
    const Mesh mesh = shapes::soup(60, 3);
    Grid grid = fitGrid(mesh, {.resolution = 12});
    grid.dims = dims;
    if (dims.x == 1) grid.origin.x += 6.0 * grid.spacing;  // Through the middle of the soup.
    const cpu::Crossings crossings = crossingsOf(mesh, grid);
    std::vector<float> field(grid.sampleCount());
    std::mt19937 random(4);
    for (float& w : field) w = std::uniform_real_distribution<float>(-1.0f, 1.0f)(random);
    float expected = 0.0f;
    for (const float part :
         cpu::sumCrossedEdges<float>(dims, crossings, [&](float&largest, const cpu::CrossedEdge&edge) {
           largest =
               std::max(largest, std::abs(float(edge.signedCount) - (field[edge.from] - field[edge.to])));
         }))
      expected = std::max(expected, part);
    ASSERT_GT(expected, 0.0f);
    cpu::RayMap map;
    buildRayMap(dims, crossings, map);
    const UploadedRays rays(kept<Probe>(), map);
    const auto change = [&](float scale, uint32_t disagreeing) {
      std::vector<float> scaled = field;
      for (float& w : scaled) w *= scale;
      const DeviceBuffer winding = upload(scaled, "winding"),
                         count = upload(std::vector{disagreeing}, "disagreeing");
      run([&](Commands& commands) {
        stage.record(commands, {.dims = dims, .axes = rays.addresses()}, winding.address(), count.address());
      });
      return download<float>(stage.change()).at(0);
    };
    EXPECT_EQ(change(1.0f, 0), 0.0f) << "where all rays agree";
    EXPECT_GT(change(100.0f, 1), 2.0f * expected);
    EXPECT_EQ(change(1.0f, 1), expected) << "smaller than the last";
  }
}

}  // namespace
}  // namespace raymap::vulkan
