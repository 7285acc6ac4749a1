// Krayer & Müller 2019, §3: all data stay on the device once the mesh is there.

#include "cell_mesh.h"

#include <cstring>

#include "shaders/cell_mesh_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kGroup = 128;

template <class T>
void fill(DeviceBuffer& buffer, const std::vector<T>& values) {
  buffer.resize<T>(values.size());
  std::memcpy(buffer.mapped<std::byte>().data(), values.data(), values.size() * sizeof(T));
}

}  // namespace

CellMesh::CellMesh(Device& device)
    : kernel_(device, shaders::kCellMesh, kGroup),
      positions_(device, "mesh positions", MemoryUse::Upload),
      vertices_(device, "mesh vertices"),
      uploadedTriangles_(device, "mesh triangles upload", MemoryUse::Upload),
      triangles_(device, "mesh triangles") {}

void CellMesh::reserve(const Mesh& mesh) {
  vertexCount_ = static_cast<uint32_t>(mesh.vertices.size());
  triangleCount_ = static_cast<uint32_t>(mesh.triangles.size());
  fill(positions_, mesh.vertices);
  fill(uploadedTriangles_, mesh.triangles);
  vertices_.resize<glm::vec3>(vertexCount_);
  triangles_.resize<glm::uvec3>(triangleCount_);
}

void CellMesh::record(Commands& commands, const Mesh& mesh, const Grid& grid) {
  const glm::dvec3 shift = mesh.origin - grid.origin;
  commands.concurrent([&] {
    commands.copy(uploadedTriangles_, triangles_, triangles_.bytes());
    commands.dispatch(kernel_,
                      {.positions = positions_.address(),
                       .vertices = vertices_.address(),
                       .shiftX = shift.x,
                       .shiftY = shift.y,
                       .shiftZ = shift.z,
                       .scale = 1.0 / grid.spacing,
                       .count = vertexCount_},
                      vertexCount_);
  });
}

}  // namespace raymap::vulkan
