#pragma once

#include <raymap/grid.h>
#include <raymap/mesh.h>

#include "commands.h"
#include "shared/cell_mesh.h"

namespace raymap::vulkan {

/// A mesh on the device, its vertices in cell units, where sample (i, j, k) of the grid lies at (i, j, k):
/// three floats a vertex and three 32-bit indices a triangle, tightly packed.
class CellMesh {
 public:
  explicit CellMesh(Device& device);

  /// Makes room for the mesh and takes it to where the device can read it. Nothing recorded before may still
  /// have to run.
  void reserve(const Mesh& mesh);
  /// For the mesh of the last `reserve`.
  void record(Commands& commands, const Mesh& mesh, const Grid& grid);

  const DeviceBuffer& vertexBuffer() const { return vertices_; }
  const DeviceBuffer& triangleBuffer() const { return triangles_; }
  uint32_t vertexCount() const { return vertexCount_; }
  uint32_t triangleCount() const { return triangleCount_; }

 private:
  Kernel<CellMeshPush> kernel_;
  DeviceBuffer positions_, vertices_, uploadedTriangles_, triangles_;
  uint32_t vertexCount_ = 0;
  uint32_t triangleCount_ = 0;
};

}  // namespace raymap::vulkan
