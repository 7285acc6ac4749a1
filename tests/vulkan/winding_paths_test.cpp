#include "vulkan/stages/winding_paths.h"

#include <cmath>

#include "cpu/sign/winding_rays.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_rays.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingPaths : public VulkanRaysTest {
 protected:
  static std::vector<float> rayAverage(const RayMap& map) {
    Progress progress;
    Buffer<float> winding;
    averageRays(RaySweep(map), progress, 1.0, winding);
    return {winding.begin(), winding.end()};
  }

  static std::vector<float> compute(WindingPathsStage& paths, const RayMap& map, const FieldOptions& options,
                                    uint32_t doubtful = 1) {
    paths.reserve(map.dims);
    const Rays rays(map);
    const DeviceBuffer winding = upload(rayAverage(map), "winding");
    const DeviceBuffer count = upload<uint32_t>({doubtful}, "doubtful");
    const WindingFields fields{
        .rays = rays.addresses(), .winding = winding.address(), .doubtful = count.address()};
    run([&](Commands& commands) {
      if (options.sign == SignMode::Paths)
        paths.recordAverage(commands, fields, options);
      else
        paths.recordEvolution(commands, fields, options);
    });
    return download<float>(winding);
  }

  static void expectTwins(const RayMap& map, const FieldOptions& options) {
    WindingPathsStage paths(device());
    comparePaths(Probe(device()), paths, map, options);
  }
};

TEST_F(VulkanWindingPaths, MatchTheCpu) {
  for (const glm::ivec3 dims : {glm::ivec3(21, 13, 17), glm::ivec3(1, 9, 30), glm::ivec3(40, 33, 36)}) {
    const RayMap map =
        rayMapOf(shapes::soup(200, 3), {.dims = dims, .origin = glm::dvec3(0.01), .spacing = 0.03});
    for (const SignMode sign : {SignMode::Paths, SignMode::Evolution})
      for (const Sampling sampling : {Sampling::Spread, Sampling::Paper})
        for (const int passes : {0, 1, 2, 5, 9})
          expectTwins(map, {.sign = sign, .passes = passes, .sampling = sampling});
  }
}

TEST_F(VulkanWindingPaths, TakeAnyOffsets) {
  const RayMap map = rayMapOf(shapes::soup(90, 8), {.dims = {12, 13, 14}, .spacing = 0.08});
  for (const SignMode sign : {SignMode::Paths, SignMode::Evolution})
    for (const Sampling sampling : {Sampling::Spread, Sampling::Paper})
      expectTwins(
          map, {.sign = sign,
                .passes = 7,
                .sampling = sampling,
                .offsets = {{0, 0, 0}, {-3, 5, 11}, {1000000000, 0, 0}, {-2000000000, 7, -9}, {0, 0, -4}}});
}

TEST_F(VulkanWindingPaths, LeaveWhatAllRaysAgreeOn) {
  const RayMap map = rayMapOf(shapes::soup(90, 8), {.dims = {12, 13, 14}, .spacing = 0.08});
  WindingPathsStage paths(device());
  for (const SignMode sign : {SignMode::Paths, SignMode::Evolution})
    EXPECT_EQ(compute(paths, map, {.sign = sign, .passes = 5}, 0), rayAverage(map));
}

}  // namespace
}  // namespace raymap::vulkan
