// Krayer & Müller 2019, §3: once the mesh is on the device, all data stay there.

#include "vulkan/stages/cell_mesh.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/ceil_div.h"
#include "method/turns.h"
#include "shaders/cell_mesh_mend_spv.h"
#include "shaders/cell_mesh_spv.h"
#include "shaders/cell_mesh_triangles_spv.h"

namespace raymap::vulkan {

CellMeshStage::CellMeshStage(Device& device)
    : toCells_(device, shaders::kCellMesh, kGroup),
      check_(device, shaders::kCellMeshTriangles, std::max(kGroup, device.limits().maxSubgroupSize)),
      mend_(device, shaders::kCellMeshMend, kGroup),
      gate_(device, "mending of the mesh"),
      vertices_(device, "mesh vertices"),
      triangles_(device, "mesh triangles"),
      status_(device, "mesh status") {
  status_.resize<CellMeshStatus>(1);
}

void CellMeshStage::reserve(uint32_t vertices, uint32_t triangles) {
  vertices_.resize<glm::vec3>(vertices);
  triangles_.resize<glm::uvec3>(triangles);
  gate_.plan(std::array{ceilDiv(std::max(vertices, triangles), kGroup)});
}

void CellMeshStage::record(Commands& commands, const Source& source, const Grid& grid, double outside,
                           VkDeviceAddress hashes) {
  const glm::dvec3 shift = source.origin - grid.origin;
  const glm::dvec3 high = glm::dvec3(grid.dims) - 0.5 + outside;
  const CellMeshPush push{.positions = source.positions,
                          .corners = source.triangles,
                          .vertices = vertices_.address(),
                          .triangles = triangles_.address(),
                          .status = status_.address(),
                          .hashes = hashes,
                          .shiftX = std::bit_cast<uint64_t>(shift.x),
                          .shiftY = std::bit_cast<uint64_t>(shift.y),
                          .shiftZ = std::bit_cast<uint64_t>(shift.z),
                          .scale = std::bit_cast<uint64_t>(1.0 / grid.spacing),
                          .stride = source.stride,
                          .vertexCount = source.vertexCount,
                          .triangleCount = source.triangleCount,
                          .low = static_cast<float>(-0.5 - outside),
                          .high = glm::vec3(high)};
  vertexCount_ = source.vertexCount;
  triangleCount_ = source.triangleCount;
  commands.fill(status_, 0);
  commands.dispatch(toCells_, push, vertexCount_);
  commands.dispatch(check_, push, triangleCount_);
  gate_.record(commands, status_.address());  // Word 0, `bad`, opens the gate.
  gate_.dispatch(commands, mend_, push, 0);
}

MeshUpload::MeshUpload(Device& device)
    : positions_(device, "mesh positions", MemoryUse::Upload),
      triangles_(device, "mesh triangles upload", MemoryUse::Upload) {}

void MeshUpload::fill(const PackedMesh& mesh) {
  positions_.fill(mesh.vertices);
  triangles_.fill(mesh.triangles);
  source_ = {.positions = positions_.address(),
             .triangles = triangles_.address(),
             .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
             .triangleCount = static_cast<uint32_t>(mesh.triangles.size()),
             .origin = mesh.origin};
}

void MeshUpload::turn(const PackedMesh& mesh, std::span<const uint8_t> turns) {
  const std::span<glm::uvec3> triangles = triangles_.mapped<glm::uvec3>();
  for (size_t f = 0; f < turns.size(); ++f) triangles[f] = turned(mesh.triangles[f], turns[f]);
}

}  // namespace raymap::vulkan
