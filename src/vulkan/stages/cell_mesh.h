#pragma once

#include <raymap/grid.h>

#include "mesh/packed_mesh.h"
#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/cell_mesh_push.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// Mesh on the device, with vertices in cell units: sample (i, j, k) of the grid lies at (i, j, k). Three
/// floats per vertex and three 32-bit indices per triangle, tightly packed. Every index is in range and every
/// vertex is finite: triangles of the source for which this fails become points on other triangles.
class CellMeshStage {
 public:
  /// Mesh that the device can read; the caller may own it.
  struct Source {
    VkDeviceAddress positions = 0;  ///< In the mesh's units.
    uint32_t stride = 3;            ///< Floats from one vertex to the next.
    VkDeviceAddress triangles = 0;  ///< Three indices each.
    uint32_t vertexCount = 0;
    uint32_t triangleCount = 0;
    glm::dvec3 origin{0.0};
  };

  explicit CellMeshStage(Device& device);

  /// Reserves memory for meshes of at most this size. All previously recorded work must have completed.
  void reserve(uint32_t vertices, uint32_t triangles);
  /// Records the conversion. Counts the triangles that reach more than `outside` samples beyond the grid.
  /// Also writes 64 bits for each vertex to `hashes`, unless that is 0: equal for equal positions.
  void record(Commands& commands, const Source& source, const Grid& grid, double outside,
              VkDeviceAddress hashes = 0);

  /// Buffers of the mesh of the last `record`.
  const DeviceBuffer& vertexBuffer() const { return vertices_; }
  const DeviceBuffer& triangleBuffer() const { return triangles_; }
  DeviceMesh mesh() const {
    return {vertices_.address(), triangles_.address(), vertexCount_, triangleCount_};
  }
  /// Buffer of one `CellMeshStatus`.
  const DeviceBuffer& status() const { return status_; }

 private:
  Kernel<CellMeshPush> toCells_, check_, mend_;
  DispatchArguments gate_;
  DeviceBuffer vertices_, triangles_, status_;
  uint32_t vertexCount_ = 0;
  uint32_t triangleCount_ = 0;
};

/// Copy of a host mesh that the device can read.
class MeshUpload {
 public:
  explicit MeshUpload(Device& device);

  /// Copies the mesh. All previously recorded work must have completed.
  void fill(const PackedMesh& mesh);
  /// Copies the triangles of the same mesh again, as the sign takes them (`Turns`).
  void turn(const PackedMesh& mesh, std::span<const uint8_t> turns);
  const CellMeshStage::Source& source() const { return source_; }

 private:
  CellMeshStage::Source source_;
  DeviceBuffer positions_, triangles_;
};

}  // namespace raymap::vulkan
