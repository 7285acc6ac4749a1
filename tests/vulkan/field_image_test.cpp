#include "vulkan/stages/field_image.h"

#include <cfloat>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "shaders/field_image_halves_spv.h"
#include "vulkan/self_test/probe_image.h"
#include "vulkan_generation.h"

namespace raymap::vulkan {
namespace {

TEST_F(VulkanGenerator, FillsImagesOfEmptyMeshes) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 9});
  const FieldOptions options{.allowEmpty = true};
  for (const VkFormat format : {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16_SFLOAT}) {
    const ProbeImage image(device(), format, grid.dims);
    DeviceBuffer texels(device(), "texels", MemoryUse::ReadBack);
    texels.resize<std::byte>(grid.sampleCount() * (format == VK_FORMAT_R32_SFLOAT ? 4 : 2));
    Room room = roomFor(mesh, grid, options);
    room.image = format;
    generator().reserve(room);
    run([&](Commands& commands) {
      generator().record(commands.handle(), {}, grid, options,
                         {.image = image.handle(), .imageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL});
      image.recordCopy(commands, texels);
    });
    for (size_t s = 0; s < grid.sampleCount(); ++s)
      if (format == VK_FORMAT_R32_SFLOAT)
        ASSERT_EQ(texels.mapped<float>()[s], FLT_MAX) << s;
      else
        ASSERT_EQ(glm::unpackHalf1x16(texels.mapped<uint16_t>()[s]), 65504.0f) << s;
  }
}

TEST_F(VulkanGenerator, FillsImages) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 15});
  for (const FieldOptions& options :
       {FieldOptions{}, FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Rays}}) {
    const Field expected = hostField(mesh, grid, options);
    const Uploaded uploaded(mesh);
    for (const VkFormat format : {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16_SFLOAT}) {
      const ProbeImage image(device(), format, grid.dims);
      DeviceBuffer texels(device(), "texels", MemoryUse::ReadBack);
      texels.resize<std::byte>(grid.sampleCount() * (format == VK_FORMAT_R32_SFLOAT ? 4 : 2));
      Room room = roomFor(mesh, grid, options);
      room.image = format;
      generator().reserve(room);
      run([&](Commands& commands) {
        const Target target{.image = image.handle(), .imageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
        for (int round = 0; round < 2; ++round)
          generator().record(commands.handle(), uploaded.buffers, grid, options, target);
        image.recordCopy(commands, texels);
      });
      if (format == VK_FORMAT_R32_SFLOAT) {
        EXPECT_EQ(0, std::memcmp(texels.mapped<float>().data(), expected.distance.data(), texels.bytes()));
        continue;
      }
      for (size_t s = 0; s < expected.distance.size(); ++s) {
        const uint16_t half = texels.mapped<uint16_t>()[s];
        const float value = glm::unpackHalf1x16(half), wanted = expected.distance[s];
        const auto distanceOf = [&](uint16_t other) { return std::abs(glm::unpackHalf1x16(other) - wanted); };
        ASSERT_LE(std::abs(value - wanted), distanceOf(half + 1)) << s;
        ASSERT_LE(std::abs(value - wanted), distanceOf(half - 1)) << s;
      }
    }
  }
}

TEST_F(VulkanGenerator, RoundsHalfFloatsToTheNearest) {
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
