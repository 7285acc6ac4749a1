#pragma once

// Runs the stages over cells on a device and returns their results in the CPU's form.

#include <memory>

#include "cpu/cells/cell_levels.h"
#include "vulkan/self_test/probe.h"
#include "vulkan/stages/raster_distance.h"
#include "vulkan/stages/refine.h"

namespace raymap::vulkan {

/// Results of all stages; of a distance transform alone, one level without lists.
struct CellResult {
  std::vector<cpu::CellLevel> levels;
  Buffer<float> distance;
  Buffer<uint32_t> triangle;
};

/// Runs the stages over cells. The stage objects are kept from one mesh to the next.
class CellProbe : public Probe {
 public:
  using Probe::Probe;

  cpu::VoxelGrid voxelGrid(const CellMesh& mesh, const CellLattice& cells) {
    const UploadedMesh uploaded = upload(mesh);
    VoxelGridStage& grid = level(0).grid;
    const auto reserve = [&](const ListSizes& lists) {
      grid.reserve(cells, uploaded.addresses().triangleCount, lists);
    };
    runUntilItFits(grid, reserve, [&](Commands& commands) { grid.record(commands, uploaded.addresses()); });
    return toLists(grid);
  }

  /// Returns a level without lists.
  cpu::CellLevel transform(const glm::ivec3& dims, const Buffer<float>& squared) {
    DistanceTransformStage& transform = level(0).transform;
    const DeviceBuffer values = upload(squared, "squared");
    transform.reserve(dims);
    run([&](Commands& commands) { transform.record(commands, values.address()); });
    requireEqual("input of the transform", download<float>(values), squared);
    return transformed(dims, squared, transform);
  }

  CellResult refine(const CellMesh& mesh, int reach) {
    const UploadedMesh uploaded = upload(mesh);
    const std::vector<CellLevelData> levels = runLevels(mesh, uploaded.addresses(), true);
    const DeviceBuffer distance = room<float>(CellLattice{mesh.dims}.count(), "distance"),
                       triangle = room<uint32_t>(CellLattice{mesh.dims}.count(), "triangle");
    refine_.reserve(mesh.dims, uploaded.addresses().triangleCount, levels);
    run([&](Commands& commands) {
      refine_.record(commands, uploaded.addresses(),
                     {.distance = distance.address(),
                      .triangle = triangle.address(),
                      .scratch = level(0).transform.scratch()},
                     reach);
    });
    CellResult result{.distance = downloadBuffer<float>(distance),
                      .triangle = downloadBuffer<uint32_t>(triangle)};
    for (size_t l = 0; l < levels.size(); ++l) {
      const CellStages& on = level(l);
      result.levels.push_back(
          transformed(on.grid.lattice().dims, downloadBuffer<float>(on.distance.squared()), on.transform));
      result.levels.back().grid = toLists(on.grid);
    }
    return result;
  }

  /// Returns levels as they are before the distance transform.
  CellResult rasterDistance(const CellMesh& mesh) {
    const UploadedMesh uploaded = upload(mesh);
    const std::vector<CellLevelData> levels = runLevels(mesh, uploaded.addresses(), false);
    const DeviceBuffer distance = room<float>(CellLattice{mesh.dims}.count(), "distance");
    samples_.reserve(mesh.dims, levels);
    run([&](Commands& commands) { samples_.record(commands, distance.address()); });
    CellResult result{.distance = downloadBuffer<float>(distance)};
    for (size_t l = 0; l < levels.size(); ++l) {
      result.levels.emplace_back().grid.cells = level(l).grid.lattice();
      result.levels.back().squared = downloadBuffer<float>(level(l).distance.squared());
    }
    return result;
  }

  /// Runs what `record` records until the stage's lists fit into their memory. Returns the number of runs.
  template <class Reserve, class Record>
  int runUntilItFits(VoxelGridStage& stage, Reserve&& reserve, Record&& record) {
    reserve(ListSizes{});
    run(record);
    int runs = 1;
    for (; !stage.fits(sizes(stage)) && runs < 4; ++runs) {
      reserve(sizes(stage));
      run(record);
    }
    require(stage.fits(sizes(stage)), "the lists do not fit after " + textOf(runs) + " runs");
    return runs;
  }

  /// Returns the list sizes that a stage counted.
  ListSizes sizes(const VoxelGridStage& stage) const {
    return sizesOf(download<VoxelGridTotals>(stage.totals()).at(0));
  }

  cpu::VoxelGrid toLists(const VoxelGridStage& grid) const {
    const auto begins = download<uint32_t>(grid.begins());
    const auto cells = download<uint32_t>(grid.cells()), triangles = download<uint32_t>(grid.triangles());
    const uint64_t entries = sizes(grid).entries;
    std::vector<uint32_t> listed;
    cpu::VoxelGrid lists{.cells = grid.lattice()};
    lists.starts.resizeUninitialized(begins.size() + 1);
    for (uint32_t c = 0; c < begins.size(); ++c) {
      lists.starts[c] = listed.size();
      if (begins[c] == kNoCell) continue;
      for (size_t e = begins[c]; e < std::min<uint64_t>(entries, cells.size()) && cells[e] == c; ++e)
        listed.push_back(triangles[e]);
      std::sort(listed.begin() + lists.starts[c], listed.end());
    }
    lists.starts[begins.size()] = listed.size();
    require(entries == listed.size(),
            "the grid lists " + textOf(listed.size()) + " triangles of " + textOf(entries));
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
  Buffer<T> downloadBuffer(const DeviceBuffer& buffer) const {
    return toBuffer(download<T>(buffer));
  }

  /// Runs the stages up to the distance transform on the lattices that cover a mesh.
  std::vector<CellLevelData> runLevels(const CellMesh& mesh, const DeviceMesh& triangles, bool hasLists) {
    std::vector<CellLevelData> levels;
    for (const CellLattice& cells : coverMesh(mesh)) {
      CellStages& on = level(levels.size());
      const auto reserve = [&](const ListSizes& lists) {
        on.reserve(cells, triangles.triangleCount, lists, hasLists);
      };
      runUntilItFits(on.grid, reserve, [&](Commands& commands) {
        on.grid.record(commands, triangles);
        on.distance.record(commands, triangles, on.grid);
        on.transform.record(commands, on.distance.squared().address());
      });
      levels.push_back(on.data());
    }
    return levels;
  }

  /// Adds the values that the formula in vulkan/stages/distance_transform.h gives.
  cpu::CellLevel transformed(const glm::ivec3& dims, const Buffer<float>& squared,
                             const DistanceTransformStage& transform) const {
    cpu::CellLevel result{.squared = squared.clone(),
                          .nearestCell = downloadBuffer<uint32_t>(transform.nearestCells())};
    const CellLattice cells{dims};
    for (size_t p = 0; p < squared.size(); ++p) {
      const uint32_t nearest = result.nearestCell[p];
      if (nearest == kNoCell) continue;
      require(nearest < squared.size(), "cell " + textOf(p) + " has cell " + textOf(nearest) + " of " +
                                            textOf(squared.size()) + " as the nearest");
      const glm::vec3 d(cells.cell(p) - cells.cell(nearest));
      result.squared[p] = d.z * d.z + (d.y * d.y + (d.x * d.x + squared[nearest]));
    }
    return result;
  }

  /// Returns the stages of a lattice, which are made when they are first asked for.
  CellStages& level(size_t number) {
    while (levels_.size() <= number) levels_.push_back(std::make_unique<CellStages>(device()));
    return *levels_[number];
  }
  std::vector<std::unique_ptr<CellStages>> levels_;
  RefineStage refine_{device()};
  RasterDistanceStage samples_{device()};
};

}  // namespace raymap::vulkan
