#include "vulkan/stages/sign.h"

#include <cmath>

#include "cpu/sign/sign.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan_rays.h"

namespace raymap::vulkan {
namespace {

constexpr glm::uvec3 kDims(21, 13, 17);

class VulkanSign : public VulkanRaysTest {
 protected:
  static RayMap map() {
    return rayMapOf(shapes::soup(60, 3), {.dims = kDims, .origin = glm::dvec3(0.0), .spacing = 0.05});
  }
  /// Returns numbers from -1.3 to 1.3, and 0.5 itself.
  static std::vector<float> windings() {
    std::vector<float> values(size_t{kDims.x} * kDims.y * kDims.z);
    for (size_t i = 0; i < values.size(); ++i) values[i] = 0.1f * (float(i % 27) - 13.0f);
    values[5] = 0.5f;
    return values;
  }
  template <class T>
  static Buffer<T> bufferOf(const std::vector<T>& values) {
    Buffer<T> buffer(values.size());
    std::copy(values.begin(), values.end(), buffer.begin());
    return buffer;
  }
};

TEST_F(VulkanSign, MatchesTheCpu) {
  const RayMap rayMap = map();
  const Rays rays(rayMap);
  const std::vector<float> values = windings();
  const std::vector<float> unsignedDistance(values.size(), 2.5f);
  const DeviceBuffer winding = upload(values, "winding");
  SignStage sign(device());
  for (const double threshold : {0.5, 0.3, 1.2})
    for (const bool isInverted : {false, true}) {
      const DeviceBuffer distance = upload(unsignedDistance, "distance"),
                         confidence = upload(unsignedDistance, "confidence");
      run([&](Commands& commands) {
        sign.record(commands,
                    {.rays = rays.addresses(),
                     .winding = winding.address(),
                     .distance = distance.address(),
                     .confidence = confidence.address()},
                    kDims, threshold, isInverted);
      });
      const Buffer<float> reference = bufferOf(values);
      Buffer<float> distances = bufferOf(unsignedDistance), confidences;
      applySign(reference, threshold, isInverted, distances);
      computeConfidence(rayMap, reference, threshold, confidences);
      const std::vector<float> ours = download<float>(distance), sure = download<float>(confidence);
      for (size_t i = 0; i < ours.size(); ++i) {
        ASSERT_EQ(ours[i], distances[i]) << i;
        ASSERT_NEAR(sure[i], confidences[i], 1e-6f) << i;
      }
    }
}

}  // namespace
}  // namespace raymap::vulkan
