#pragma once

// Runs the stages over cells on a device and returns their results in the CPU's form.

#include <array>

#include "cells.h"
#include "vulkan/stages/raster_distance.h"
#include "vulkan/stages/refine.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// A mesh in cell units on the device.
struct UploadedMesh {
  DeviceBuffer vertices;
  DeviceBuffer triangles;

  DeviceMesh addresses() const {
    return {.vertices = vertices.address(),
            .triangles = triangles.address(),
            .vertexCount = static_cast<uint32_t>(vertices.bytes() / sizeof(glm::vec3)),
            .triangleCount = static_cast<uint32_t>(triangles.bytes() / sizeof(glm::uvec3))};
  }
};

struct TransformResult {
  Buffer<float> squared;
  Buffer<uint32_t> cells;
};

struct RefineResult {
  std::vector<cpu::CellLevel> levels;
  Buffer<float> distance;
  Buffer<uint32_t> triangle;
};

/// Runs the stages on the device of the tests. The stage objects are kept from one mesh to the next.
class CellStages : public VulkanTest {
 public:
  static cpu::VoxelGrid voxelGrid(const CellMesh& mesh, const CellLattice& cells) {
    const UploadedMesh uploaded = uploadMesh(mesh);
    VoxelGridStage& grid = stages().levels[0].grid;
    const auto reserve = [&](const ListSizes& lists) {
      grid.reserve(cells, uploaded.addresses().triangleCount, lists);
    };
    runUntilItFits(grid, reserve, [&](Commands& commands) { grid.record(commands, uploaded.addresses()); });
    return toLists(grid);
  }

  static Buffer<float> cellDistance(const CellMesh& mesh, const CellLattice& cells) {
    const UploadedMesh uploaded = uploadMesh(mesh);
    Level& level = stages().levels[0];
    const auto reserve = [&](const ListSizes& lists) {
      level.reserve(cells, uploaded.addresses().triangleCount, lists);
    };
    runUntilItFits(level.grid, reserve, [&](Commands& commands) {
      level.grid.record(commands, uploaded.addresses());
      level.distance.record(commands, uploaded.addresses(), level.grid);
    });
    return downloadBuffer<float>(level.distance.squared());
  }

  static TransformResult transform(const glm::ivec3& dims, const Buffer<float>& squared) {
    DistanceTransformStage& transform = stages().levels[0].transform;
    const DeviceBuffer values = upload(std::vector<float>(squared.begin(), squared.end()), "squared");
    transform.reserve(dims);
    run([&](Commands& commands) { transform.record(commands, values.address()); });
    EXPECT_TRUE(std::ranges::equal(download<float>(values), squared));
    return transformed(dims, squared, transform);
  }

  static RefineResult refine(const CellMesh& mesh, int reach) {
    const UploadedMesh uploaded = uploadMesh(mesh);
    const auto triangles = uploaded.addresses();
    const std::vector<CellLattice> lattices = coverMesh(mesh);
    for (size_t l = 0; l < lattices.size(); ++l) {
      Level& level = stages().levels.at(l);
      const auto reserve = [&](const ListSizes& lists) {
        level.reserve(lattices[l], triangles.triangleCount, lists);
      };
      runUntilItFits(level.grid, reserve, [&](Commands& commands) {
        level.grid.record(commands, triangles);
        level.distance.record(commands, triangles, level.grid);
        level.transform.record(commands, level.distance.squared().address());
      });
    }
    std::vector<CellLevelData> data;
    for (size_t l = 0; l < lattices.size(); ++l) data.push_back(stages().levels[l].data());
    DeviceBuffer distance(device(), "distance"), triangle(device(), "triangle");
    distance.resize<float>(CellLattice{mesh.dims}.count());
    triangle.resize<uint32_t>(CellLattice{mesh.dims}.count());
    stages().refine.reserve(mesh.dims, data);
    run([&](Commands& commands) {
      stages().refine.record(commands, triangles,
                             {.distance = distance.address(),
                              .triangle = triangle.address(),
                              .scratch = stages().levels[0].transform.scratch()},
                             reach);
    });
    RefineResult result{.distance = downloadBuffer<float>(distance),
                        .triangle = downloadBuffer<uint32_t>(triangle)};
    for (size_t l = 0; l < lattices.size(); ++l) result.levels.push_back(stages().levels[l].onTheCpu());
    return result;
  }

  /// Returns the levels before the distance transform.
  static std::vector<cpu::CellLevel> rasterize(const CellMesh& mesh) {
    const UploadedMesh uploaded = uploadMesh(mesh);
    std::vector<cpu::CellLevel> result;
    for (const CellLattice& cells : coverMesh(mesh)) {
      Level& level = stages().levels.at(result.size());
      const auto reserve = [&](const ListSizes& lists) {
        level.raster.reserve(cells, uploaded.addresses().triangleCount, lists);
      };
      runUntilItFits(level.raster, reserve,
                     [&](Commands& commands) { level.raster.record(commands, uploaded.addresses()); });
      result.emplace_back().grid.cells = cells;
      result.back().squared = downloadBuffer<float>(level.raster.squared());
    }
    return result;
  }

  static Buffer<float> rasterDistance(const CellMesh& mesh) {
    std::vector<CellLevelData> data;
    for (const cpu::CellLevel& rasterized : rasterize(mesh)) {
      Level& level = stages().levels.at(data.size());
      level.transform.reserve(rasterized.grid.cells.dims);
      data.push_back(level.raster.level(level.transform));
    }
    DeviceBuffer distance(device(), "distance");
    distance.resize<float>(CellLattice{mesh.dims}.count());
    stages().samples.reserve(mesh.dims, data);
    run([&](Commands& commands) {
      for (size_t l = 0; l < data.size(); ++l) stages().levels[l].transform.record(commands, data[l].squared);
      stages().samples.record(commands, distance.address());
    });
    return downloadBuffer<float>(distance);
  }

  static UploadedMesh uploadMesh(const CellMesh& mesh) {
    return {upload(std::vector<glm::vec3>(mesh.vertices.begin(), mesh.vertices.end()), "vertices"),
            upload(std::vector<glm::uvec3>(mesh.triangles.begin(), mesh.triangles.end()), "triangles")};
  }

  /// Runs what `record` records until the stage's lists fit into their memory. Returns the number of runs.
  template <class Stage, class Reserve, class Record>
  static int runUntilItFits(Stage& stage, Reserve&& reserve, Record&& record) {
    reserve(ListSizes{});
    run(record);
    int runs = 1;
    for (; !stage.fits(sizes(stage)) && runs < 4; ++runs) {
      reserve(sizes(stage));
      run(record);
    }
    EXPECT_TRUE(stage.fits(sizes(stage)));
    return runs;
  }

  /// Returns the list sizes that a stage counted.
  template <class Stage>
  static ListSizes sizes(const Stage& stage) {
    return sizesOf(download<CellRunsTotals>(stage.totals()).at(0));
  }

  static cpu::VoxelGrid toLists(const VoxelGridStage& grid) {
    const auto begins = download<uint32_t>(grid.begins());
    const auto cells = download<uint32_t>(grid.cells()), triangles = download<uint32_t>(grid.triangles());
    const uint64_t entries = sizes(grid).entries;
    std::vector<uint32_t> listed;
    cpu::VoxelGrid lists{.cells = grid.lattice()};
    lists.starts.resizeUninitialized(begins.size() + 1);
    for (uint32_t c = 0; c < begins.size(); ++c) {
      lists.starts[c] = listed.size();
      if (begins[c] == kNoCell) continue;
      for (size_t e = begins[c]; e < entries && cells[e] == c; ++e) listed.push_back(triangles[e]);
    }
    lists.starts[begins.size()] = listed.size();
    EXPECT_EQ(entries, listed.size());
    lists.triangles = toBuffer(listed);
    return lists;
  }

 private:
  template <class T>
  static Buffer<T> toBuffer(const std::vector<T>& values) {
    Buffer<T> buffer(values.size());
    std::ranges::copy(values, buffer.begin());
    return buffer;
  }
  template <class T>
  static Buffer<T> downloadBuffer(const DeviceBuffer& buffer) {
    return toBuffer(download<T>(buffer));
  }

  /// Adds the values that the formula in vulkan/stages/distance_transform.h gives.
  static TransformResult transformed(const glm::ivec3& dims, const Buffer<float>& squared,
                                     const DistanceTransformStage& transform) {
    TransformResult result{squared.clone(), downloadBuffer<uint32_t>(transform.nearestCells())};
    const CellLattice cells{dims};
    for (size_t p = 0; p < squared.size(); ++p) {
      const uint32_t nearest = result.cells[p];
      if (nearest == kNoCell) continue;
      const glm::vec3 d(cells.cell(p) - cells.cell(nearest));
      result.squared[p] = d.z * d.z + (d.y * d.y + (d.x * d.x + squared[nearest]));
    }
    return result;
  }

  struct Level {
    VoxelGridStage grid{device()};
    CellDistanceStage distance{device()};
    DistanceTransformStage transform{device()};
    RasterDistanceStage raster{device()};

    void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists) {
      grid.reserve(cells, triangles, lists);
      distance.reserve(cells.count());
      transform.reserve(cells.dims);
    }
    CellLevelData data() const { return levelOf(grid, distance, transform); }
    cpu::CellLevel onTheCpu() const {
      TransformResult result =
          transformed(grid.lattice().dims, downloadBuffer<float>(distance.squared()), transform);
      return {toLists(grid), std::move(result.squared), std::move(result.cells)};
    }
  };
  struct Stages {
    std::array<Level, kMostLevels> levels;
    RefineStage refine{device()};
    RasterDistanceSamplesStage samples{device()};
  };
  static Stages& stages() {
    shared();  // The device is made before the stages, so it is destroyed after them.
    static Stages stages;
    return stages;
  }
};

}  // namespace raymap::vulkan
