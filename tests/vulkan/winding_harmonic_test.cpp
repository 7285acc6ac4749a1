#include "vulkan/stages/winding_harmonic.h"

#include <cmath>

#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_rays.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingHarmonic : public VulkanRaysTest {
 protected:
  static std::vector<float> solve(WindingHarmonicStage& harmonic, const RayMap& map, uint32_t doubtful) {
    harmonic.reserve(map.dims);
    const DeviceBuffer count = upload<uint32_t>({doubtful}, "doubtful");
    const Rays rays(map);
    const size_t samples = size_t(map.dims.x) * size_t(map.dims.y) * size_t(map.dims.z);
    const DeviceBuffer winding = upload(std::vector<float>(samples, 7.0f), "winding");
    run([&](Commands& commands) {
      harmonic.record(commands,
                      {.rays = rays.addresses(), .winding = winding.address(), .doubtful = count.address()});
    });
    return download<float>(winding);
  }
};

Mesh holedSphere() {
  Mesh mesh = shapes::sphere(1.0, 3);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.6; });
  return mesh;
}

TEST_F(VulkanWindingHarmonic, MatchesTheCpu) {
  WindingHarmonicStage harmonic(device());
  for (const Mesh& mesh : {holedSphere(), shapes::soup(300, 4)})
    for (const glm::ivec3 dims : {glm::ivec3(33, 20, 41), glm::ivec3(48, 48, 48), glm::ivec3(1, 9, 30)}) {
      SCOPED_TRACE(::testing::Message() << dims.x << " x " << dims.y << " x " << dims.z);
      const Box box = bounds(mesh);
      const double spacing = 1.2 * std::max({box.size().x, box.size().y, box.size().z}) / 40.0;
      const Grid grid{
          .dims = dims, .origin = box.centre() - 0.5 * spacing * glm::dvec3(dims), .spacing = spacing};
      const RayMap map = rayMapOf(mesh, grid);
      compareHarmonic(Probe(device()), harmonic, map);
    }
}

TEST_F(VulkanWindingHarmonic, SolvesNothingWhereAllRaysAgree) {
  WindingHarmonicStage harmonic(device());
  const Mesh mesh = shapes::sphere(1.0, 2);
  for (const float w : solve(harmonic, rayMapOf(mesh, fitGrid(mesh, {.resolution = 20})), 0))
    ASSERT_EQ(w, 7.0f);
}

}  // namespace
}  // namespace raymap::vulkan
