#include "vulkan/stages/winding_doubts.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "cpu/sign/crossings_lines.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan_rays.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingDoubts : public VulkanRaysTest {};

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
    const Rays rays(map);
    const DeviceBuffer disagreeing = upload<uint32_t>({1}, "disagreeing"),
                       agreeing = upload<uint32_t>({0}, "agreeing"), given = upload(field, "winding");
    run([&](Commands& commands) {
      stage.record(commands, {.dims = dims, .axes = rays.addresses()}, given.address(), agreeing.address());
    });
    EXPECT_EQ(download<float>(stage.change()).at(0), 0.0f) << "where all rays agree";
    for (const float scale : {100.0f, 1.0f}) {  // The second result is smaller than the first.
      std::vector<float> scaled = field;
      for (float& w : scaled) w *= scale;
      const DeviceBuffer winding = upload(scaled, "winding");
      run([&](Commands& commands) {
        stage.record(commands, {.dims = dims, .axes = rays.addresses()}, winding.address(),
                     disagreeing.address());
      });
      if (scale == 1.0f)
        EXPECT_EQ(download<float>(stage.change()).at(0), expected);
      else
        EXPECT_GT(download<float>(stage.change()).at(0), 2.0f * expected);
    }
  }
}

}  // namespace
}  // namespace raymap::vulkan
