#pragma once

#include <raymap/grid.h>
#include <raymap/mesh.h>

#include "vulkan/primitives/gate.h"
#include "vulkan/stages/cell_mesh_push.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// A mesh on the device, its vertices in cell units, where sample (i, j, k) of the grid lies at (i, j, k):
/// three floats a vertex and three 32-bit indices a triangle, tightly packed. Whatever it is made from, no
/// index is out of range and no vertex infinite or not a number: triangles that had such have become points
/// on others.
class CellMeshStage {
 public:
  /// A mesh that the device can read, perhaps someone else's.
  struct Source {
    VkDeviceAddress positions = 0;  ///< In the mesh's units.
    uint32_t stride = 3;            ///< Floats from one to the next.
    VkDeviceAddress triangles = 0;  ///< Three indices each.
    uint32_t vertexCount = 0;
    uint32_t triangleCount = 0;
    glm::dvec3 origin{0.0};
  };

  explicit CellMeshStage(Device& device);

  /// Makes room for meshes of up to so many. Nothing recorded before may still have to run.
  void reserve(uint32_t vertices, uint32_t triangles);
  /// Counts triangles that reach so many samples beyond the grid.
  void record(Commands& commands, const Source& source, const Grid& grid, double outside);

  /// Of the mesh of the last `record`.
  const DeviceBuffer& vertexBuffer() const { return vertices_; }
  const DeviceBuffer& triangleBuffer() const { return triangles_; }
  DeviceMesh mesh() const {
    return {vertices_.address(), triangles_.address(), vertexCount_, triangleCount_};
  }
  /// One `CellMeshStatus`.
  const DeviceBuffer& status() const { return status_; }

 private:
  Kernel<CellMeshPush> toCells_, check_, mend_;
  Gate gate_;
  DeviceBuffer vertices_, triangles_, status_;
  uint32_t vertexCount_ = 0;
  uint32_t triangleCount_ = 0;
};

/// A mesh of the host's where the device can read it.
class MeshUpload {
 public:
  explicit MeshUpload(Device& device);

  /// Nothing recorded before may still have to run.
  void fill(const Mesh& mesh);
  /// The same mesh, some faces the other way round: those with a 1.
  void turn(const Mesh& mesh, std::span<const uint8_t> turns);
  const CellMeshStage::Source& source() const { return source_; }

 private:
  CellMeshStage::Source source_;
  DeviceBuffer positions_, triangles_;
};

}  // namespace raymap::vulkan
