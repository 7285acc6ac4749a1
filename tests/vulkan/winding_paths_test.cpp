#include "vulkan/stages/winding_paths.h"

#include <cmath>

#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingPaths : public VulkanTest {
 protected:
  static void expectTwins(const RayMap& map, const FieldOptions& options) {
    comparePaths(kept<Probe>(), kept<WindingPathsStage>(), map, options);
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
  auto& paths = kept<WindingPathsStage>();
  paths.reserve(map.dims);
  const std::vector<float> before(size_t(12) * 13 * 14, 0.25f);
  EXPECT_EQ(windingAfter(kept<Probe>(), map, before, 0,
                         [&](Commands& commands, const auto& fields) {
                           paths.recordAverage(commands, fields, {.sign = SignMode::Paths, .passes = 5});
                           paths.recordEvolution(commands, fields,
                                                 {.sign = SignMode::Evolution, .passes = 5});
                         }),
            before);
}

}  // namespace
}  // namespace raymap::vulkan
