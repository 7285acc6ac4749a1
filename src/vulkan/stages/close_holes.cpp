// Krayer & Müller 2019, §4, end: adds surface where the sign changes but no triangle crosses.

#include "vulkan/stages/close_holes.h"

#include <algorithm>
#include <tuple>

#include "method/cell_lattice.h"
#include "shaders/close_holes_spv.h"

namespace raymap::vulkan {

CloseHolesStage::CloseHolesStage(Device& device)
    : search_(device, shaders::kCloseHoles, kGroup),
      count_(device, "number of missing edges"),
      hostCount_(device, "number of missing edges for the host", MemoryUse::ReadBack),
      edges_(device, "missing edges"),
      hostEdges_(device, "missing edges for the host", MemoryUse::ReadBack),
      points_(device, "points on missing edges", MemoryUse::Upload),
      numbers_(device, "winding numbers on missing edges"),
      hostNumbers_(device, "winding numbers on missing edges for the host", MemoryUse::ReadBack),
      patchVertices_(device, "vertices of the patch", MemoryUse::Upload),
      patchTriangles_(device, "triangles of the patch", MemoryUse::Upload),
      patchTree_(device),
      patchDistance_(device) {
  count_.resize<uint32_t>(1);
  hostCount_.resize<uint32_t>(1);
}

void CloseHolesStage::recordSearch(Commands& commands, const glm::ivec3& dims, const CrossedEdges& crossed,
                                   VkDeviceAddress winding, double threshold) {
  const CloseHolesPush push{.crossed = crossed.bits,
                            .winding = winding,
                            .count = count_.address(),
                            .edges = edges_.address(),
                            .room = room_,
                            .crossedWords = crossed.words,
                            .dims = glm::uvec3(dims),
                            .threshold = static_cast<float>(threshold)};
  commands.fill(count_, 0);
  commands.dispatch(search_, push, CellLattice{dims}.count());
  commands.copy(count_, hostCount_, count_.bytes());
  if (room_ > 0) commands.copy(edges_, hostEdges_, edges_.bytes());
}

bool CloseHolesStage::growIfFull() {
  const uint32_t count = hostCount_.mapped<uint32_t>().front();
  if (count <= room_) return false;
  room_ = count;
  edges_.resize<MissingEdge>(room_);
  hostEdges_.resize<MissingEdge>(room_);
  return true;
}

std::vector<MissingEdge> CloseHolesStage::edges() const {
  const std::span<const MissingEdge> found = hostEdges_.mapped<const MissingEdge>();
  std::vector<MissingEdge> edges(found.begin(), found.begin() + hostCount_.mapped<uint32_t>().front());
  std::ranges::sort(edges, {}, [](const MissingEdge& edge) { return std::tuple(edge.first, edge.axis); });
  return edges;
}

void CloseHolesStage::recordNumbersAt(Commands& commands, WindingDipolesStage& dipoles,
                                      const SurfaceTreeStage& tree, std::span<const glm::vec3> points,
                                      double threshold) {
  points_.fill(points);
  numbers_.resize<float>(points.size());
  hostNumbers_.resize<float>(points.size());
  dipoles.recordNumbersAt(commands, tree, points_.address(), static_cast<uint32_t>(points.size()),
                          numbers_.address(), threshold);
  commands.copy(numbers_, hostNumbers_, numbers_.bytes());
}

std::vector<float> CloseHolesStage::numbers() const {
  const std::span<const float> numbers = hostNumbers_.mapped<const float>();
  return {numbers.begin(), numbers.end()};
}

void CloseHolesStage::recordDistance(Commands& commands, const HolePatch& patch,
                                     const ExactDistanceStage::Fields& fields) {
  const auto& mesh = patch.mesh;
  patchVertices_.fill(mesh.vertices);
  patchTriangles_.fill(patch.triangles);
  const DeviceMesh onDevice{.vertices = patchVertices_.address(),
                            .triangles = patchTriangles_.address(),
                            .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
                            .triangleCount = static_cast<uint32_t>(patch.triangles.size())};
  patchTree_.reserve(onDevice.triangleCount);
  patchTree_.recordClear(commands);
  patchTree_.record(commands, onDevice, mesh.dims);
  patchDistance_.reserve(mesh.dims);
  patchDistance_.record(commands, patchTree_, 0.0, fields, true);
}

}  // namespace raymap::vulkan
