#include "vulkan/cell_mesh.h"

#include "shapes.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanCellMesh : public VulkanTest {
 protected:
  static std::vector<float> vertices(const Mesh& mesh, const Grid& grid) {
    CellMesh cells(device());
    cells.reserve(mesh);
    run([&](Commands& commands) { cells.record(commands, mesh, grid); });
    return download<float>(cells.vertexBuffer());
  }
};

TEST_F(VulkanCellMesh, HasTheCpusBits) {
  for (const double far : {0.0, 12345.678, 1e9}) {
    Mesh mesh = shapes::soup(2000, 5);
    mesh.origin += far;
    const Grid grid{.dims = {50, 50, 50}, .origin = glm::dvec3(far - 0.123), .spacing = 0.0173};
    const std::vector<float> ours = vertices(mesh, grid);
    const glm::dvec3 shift = mesh.origin - grid.origin;
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(ours[3 * v + size_t(axis)],
                  float((shift[axis] + double(mesh.vertices[v][axis])) * (1.0 / grid.spacing)));
  }
}

TEST_F(VulkanCellMesh, KeepsTheTriangles) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  CellMesh cells(device());
  cells.reserve(mesh);
  run([&](Commands& commands) { cells.record(commands, mesh, {.dims = {4, 4, 4}, .spacing = 1.0}); });
  EXPECT_EQ(download<glm::uvec3>(cells.triangleBuffer()), mesh.triangles);
}

}  // namespace
}  // namespace raymap::vulkan
