#pragma once

#include "cells.h"
#include "vulkan/voxel_grid.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// A mesh in cell units on the device.
struct UploadedMesh {
  DeviceBuffer vertices;
  DeviceBuffer triangles;

  CellRuns::Triangles addresses() const {
    return {.vertices = vertices.address(),
            .triangles = triangles.address(),
            .count = static_cast<uint32_t>(triangles.bytes() / sizeof(glm::uvec3))};
  }
};

/// A test of the stages over cells.
class VulkanCellsTest : public VulkanTest {
 protected:
  static UploadedMesh uploadMesh(const CellMesh& mesh) {
    return {upload(std::vector<glm::vec3>(mesh.vertices.begin(), mesh.vertices.end()), "vertices"),
            upload(std::vector<glm::uvec3>(mesh.triangles.begin(), mesh.triangles.end()), "triangles")};
  }

  /// Runs what `record` records until the grid has room for all entries; gives how often it ran.
  template <class Record>
  static int runUntilItFits(VoxelGrid& grid, Record&& record) {
    run(record);
    int runs = 1;
    for (; !grid.fits() && runs < 4; ++runs) {
      grid.grow();
      run(record);
    }
    EXPECT_TRUE(grid.fits());
    return runs;
  }
};

}  // namespace raymap::vulkan
