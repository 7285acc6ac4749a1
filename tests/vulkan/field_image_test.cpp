#include "vulkan/stages/field_image.h"

#include <cfloat>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "shaders/field_image_halves_spv.h"
#include "vulkan/self_test/probe_image.h"
#include "vulkan_generation.h"

namespace raymap::vulkan {
namespace {

class VulkanFieldImage : public VulkanGenerator {
 protected:
  /// Records the same frame twice, and returns the texels of its image.
  template <class Texel>
  static DeviceBuffer texelsOf(const MeshBuffers& mesh, const Grid& grid, const FieldOptions& options) {
    const VkFormat format = sizeof(Texel) == 4 ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R16_SFLOAT;
    const ProbeImage image(device(), format, grid.dims);
    DeviceBuffer texels(device(), "texels", MemoryUse::ReadBack);
    texels.resize<Texel>(grid.sampleCount());
    Room room = roomFor(holedSphere(), grid, options);
    room.image = format;
    generator().reserve(room);
    run([&](Commands& commands) {
      const Target target{.image = image.handle(), .imageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
      for (int round = 0; round < 2; ++round)
        generator().record(commands.handle(), mesh, grid, options, target);
      image.recordCopy(commands, texels);
    });
    return texels;
  }
};

TEST_F(VulkanFieldImage, IsFarFromEmptyMeshes) {
  const Grid grid = fitGrid(holedSphere(), {.resolution = 9});
  const FieldOptions options{.allowEmpty = true};
  const DeviceBuffer floats = texelsOf<float>({}, grid, options),
                     halves = texelsOf<uint16_t>({}, grid, options);
  for (size_t s = 0; s < grid.sampleCount(); ++s) {
    ASSERT_EQ(floats.mapped<float>()[s], FLT_MAX) << s;
    ASSERT_EQ(glm::unpackHalf1x16(halves.mapped<uint16_t>()[s]), 65504.0f) << s;
  }
}

TEST_F(VulkanFieldImage, HoldsTheDistances) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 15});
  const Uploaded uploaded(mesh);
  for (const FieldOptions& options :
       {FieldOptions{}, FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Rays}}) {
    const Field expected = hostField(mesh, grid, options);
    const DeviceBuffer floats = texelsOf<float>(uploaded.buffers, grid, options);
    requireEqual("texels", floats.mapped<float>(), expected.distance);
    const DeviceBuffer halves = texelsOf<uint16_t>(uploaded.buffers, grid, options);
    requireNearestHalves(halves.mapped<uint16_t>(), expected.distance);
  }
}

TEST_F(VulkanFieldImage, RoundsHalfFloatsToTheNearest) {
  Kernel<HalfFloatsPush> kernel(device(), shaders::kFieldImageHalves, 64);
  std::vector<float> values;
  for (uint32_t bits = 0; bits < 0x7c00;
       ++bits) {  // Every half, and the floats at and beside the middle to the next.
    const float half = glm::unpackHalf1x16(uint16_t(bits)), next = glm::unpackHalf1x16(uint16_t(bits + 1));
    const float middle = bits == 0x7bff ? 65520.0f : 0.5f * (half + next);
    values.insert(values.end(),
                  {half, -middle, std::nextafter(middle, 0.0f), std::nextafter(middle, INFINITY)});
  }
  values.insert(values.end(), {1e6f, -3e38f, 1e-40f});
  const DeviceBuffer from = upload(values);
  DeviceBuffer to(device(), "halves");
  to.resize<uint32_t>((values.size() + 1) / 2);
  run([&](Commands& commands) {
    commands.dispatch(kernel,
                      {.values = from.address(), .halves = to.address(), .count = uint32_t(values.size())},
                      (values.size() + 1) / 2);
  });
  const auto ours = download<uint32_t>(to);
  const auto half = [&](size_t i) { return uint16_t(ours[i / 2] >> (i % 2 * 16)); };
  for (uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const bool isLast = bits == 0x7bff;
    ASSERT_EQ(half(4 * bits), bits);
    ASSERT_EQ(half(4 * bits + 1), 0x8000u | (bits + (isLast ? 0 : bits & 1)));
    ASSERT_EQ(half(4 * bits + 2), bits);
    ASSERT_EQ(half(4 * bits + 3), isLast ? bits : bits + 1);
  }
  EXPECT_EQ(half(values.size() - 3), 0x7bffu);
  EXPECT_EQ(half(values.size() - 2), 0xfbffu);
  EXPECT_EQ(half(values.size() - 1), 0u);
}

}  // namespace
}  // namespace raymap::vulkan
