#include "vulkan/self_test/self_test.h"

#include <cmath>
#include <set>

#include "vulkan/self_test/difference.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanSelfTest : public VulkanTest {
 protected:
  static size_t number() {
    const char* index = std::getenv("RAYMAP_VULKAN_DEVICE");
    if (index) return std::stoul(index);
    return bestDevice(listDevices()).value();
  }
};

std::string differenceOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Difference& difference) {
    return difference.what();
  }
  return "";
}

TEST_F(VulkanSelfTest, Passes) {
  std::set<std::string> names;
  double done = -1.0;
  testDevice(number(), {.begin =
                            [&](const char*, double share) {
                              EXPECT_GE(share, done);
                              EXPECT_LT(share, 1.0);
                              done = share;
                              return true;
                            },
                        .found =
                            [&](DeviceCheck check) {
                              EXPECT_EQ(check.difference, "") << check.name;
                              EXPECT_TRUE(names.insert(check.name).second) << check.name;
                            }});
  for (const char* name : {"scan",
                           "radix_sort",
                           "cell_mesh",
                           "voxel_grid",
                           "distance_transform",
                           "cell and raster distance",
                           "refine",
                           "surface_tree",
                           "exact_distance",
                           "crossings and rays",
                           "winding_harmonic",
                           "winding_paths",
                           "winding_dipoles",
                           "face_search",
                           "orientation",
                           "close_holes",
                           "finish",
                           "default fields",
                           "quick fields",
                           "skin",
                           "field_image",
                           "render_field"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST_F(VulkanSelfTest, StopsWhenAsked) {
  int begun = 0, found = 0;
  testDevice(number(), {.begin = [&](const char*, double) { return ++begun < 3; },
                        .found = [&](const DeviceCheck&) { ++found; }});
  EXPECT_EQ(begun, 3);
  EXPECT_EQ(found, 1);
}

TEST(Difference, NamesTheFirst) {
  const std::vector<uint32_t> right{4, 5, 6, 7};
  EXPECT_EQ(differenceOf([&] { requireEqual("sums", right, right); }), "");
  EXPECT_EQ(differenceOf([&] {
              requireEqual("sums", std::vector<uint32_t>{4, 9, 6, 8}, right);
            }),
            "sums: number 1 is 9, not 5; 2 of 4 differ");
  EXPECT_EQ(differenceOf([&] { requireEqual("sums", std::vector<uint32_t>{4}, right); }),
            "sums: 1 values, not 4");
  EXPECT_EQ(differenceOf([] { inCase("torus", [] { inCase("keys", [] { require(false, "no"); }); }); }),
            "torus: keys: no");
}

TEST(Difference, AllowsWhatItIsTold) {
  const std::vector<float> right{1.0f, 100.0f};
  const auto near = [&](float a, float b, double allowed, double relative) {
    return differenceOf([&] { requireNear("w", std::vector{a, b}, right, allowed, relative); });
  };
  EXPECT_EQ(near(1.5f, 100.5f, 0.5, 0.0), "");
  EXPECT_EQ(near(1.0f, 101.0f, 0.0, 0.01), "");
  EXPECT_EQ(near(1.25f, 100.0f, 0.125, 0.0), "w: number 0 is 1.25, not 1; 1 of 2 differ");
  EXPECT_EQ(near(1.0f, 102.0f, 0.0, 0.01), "w: number 1 is 102, not 100; 1 of 2 differ");
  EXPECT_EQ(near(1.0f, NAN, 1e9, 1e9), "w: number 1 is nan, not 100; 1 of 2 differ");
}

}  // namespace
}  // namespace raymap::vulkan
