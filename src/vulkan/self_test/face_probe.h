#pragma once

#include "vulkan/self_test/probe.h"
#include "vulkan/stages/face_search.h"

namespace raymap::vulkan {

/// Searches in a mesh, which may have fewer vertices and faces than are reserved.
inline void searchFaces(const Probe& probe, FaceSearchStage& search, const Mesh& mesh) {
  MeshUpload upload(probe.device());
  CellMeshStage cells(probe.device());
  upload.fill(mesh);
  const CellMeshStage::Source& source = upload.source();
  cells.reserve(source.vertexCount, source.triangleCount);
  search.reserve(source.vertexCount + 5, source.triangleCount + 7);
  const Grid grid{.dims = glm::ivec3(1), .spacing = 1.0};
  probe.run([&](Commands& commands) {
    cells.record(commands, source, grid, 0.0, search.vertexHashes());
    search.record(commands, cells.mesh());
  });
}

}  // namespace raymap::vulkan
