#include "vulkan/stages/finish.h"

#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanFinish : public VulkanTest {};

TEST_F(VulkanFinish, ScalesAndClamps) {
  const std::vector<float> values{-5.0f, -3.0f, -0.25f, 0.0f, 1.5f, 3.5f};
  FinishStage finish(device());
  const auto finished = [&](double band) {
    const DeviceBuffer distance = upload(values, "distance");
    run([&](Commands& commands) {
      finish.record(commands, distance.address(), uint32_t(values.size()), band, 0.5);
    });
    return download<float>(distance);
  };
  EXPECT_EQ(finished(0.0), (std::vector<float>{-2.5f, -1.5f, -0.125f, 0.0f, 0.75f, 1.75f}));
  EXPECT_EQ(finished(3.0), (std::vector<float>{-1.5f, -1.5f, -0.125f, 0.0f, 0.75f, 1.5f}));
}

}  // namespace
}  // namespace raymap::vulkan
