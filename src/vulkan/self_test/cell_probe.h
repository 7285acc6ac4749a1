#pragma once

// Runs the stages over cells on a device and returns their results in the CPU's form.

#include <memory>

#include "cpu/cells/cell_levels.h"
#include "vulkan/self_test/probe.h"
#include "vulkan/stages/raster_distance.h"
#include "vulkan/stages/refine.h"

namespace raymap::vulkan {

struct TransformResult {
  Buffer<float> squared;
  Buffer<uint32_t> cells;
};

struct RefineResult {
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

  Buffer<float> cellDistance(const CellMesh& mesh, const CellLattice& cells) {
    const UploadedMesh uploaded = upload(mesh);
    CellStages& on = level(0);
    const auto reserve = [&](const ListSizes& lists) {
      on.reserve(cells, uploaded.addresses().triangleCount, lists);
    };
    runUntilItFits(on.grid, reserve, [&](Commands& commands) {
      on.grid.record(commands, uploaded.addresses());
      on.distance.record(commands, uploaded.addresses(), on.grid);
    });
    return downloadBuffer<float>(on.distance.squared());
  }

  TransformResult transform(const glm::ivec3& dims, const Buffer<float>& squared) {
    DistanceTransformStage& transform = level(0).transform;
    const DeviceBuffer values = upload(squared, "squared");
    transform.reserve(dims);
    run([&](Commands& commands) { transform.record(commands, values.address()); });
    requireEqual("input of the transform", download<float>(values), squared);
    return transformed(dims, squared, transform);
  }

  RefineResult refine(const CellMesh& mesh, int reach) {
    const UploadedMesh uploaded = upload(mesh);
    const auto triangles = uploaded.addresses();
    const std::vector<CellLattice> lattices = coverMesh(mesh);
    for (size_t l = 0; l < lattices.size(); ++l) {
      CellStages& on = level(l);
      const auto reserve = [&](const ListSizes& lists) {
        on.reserve(lattices[l], triangles.triangleCount, lists);
      };
      runUntilItFits(on.grid, reserve, [&](Commands& commands) {
        on.grid.record(commands, triangles);
        on.distance.record(commands, triangles, on.grid);
        on.transform.record(commands, on.distance.squared().address());
      });
    }
    std::vector<CellLevelData> data;
    for (size_t l = 0; l < lattices.size(); ++l) data.push_back(level(l).data());
    DeviceBuffer distance(device(), "distance"), triangle(device(), "triangle");
    distance.resize<float>(CellLattice{mesh.dims}.count());
    triangle.resize<uint32_t>(CellLattice{mesh.dims}.count());
    refine_.reserve(mesh.dims, triangles.triangleCount, data);
    run([&](Commands& commands) {
      refine_.record(commands, triangles,
                     {.distance = distance.address(),
                      .triangle = triangle.address(),
                      .scratch = level(0).transform.scratch()},
                     reach);
    });
    RefineResult result{.distance = downloadBuffer<float>(distance),
                        .triangle = downloadBuffer<uint32_t>(triangle)};
    for (size_t l = 0; l < lattices.size(); ++l) result.levels.push_back(onTheCpu(level(l)));
    return result;
  }

  /// Returns the levels before the distance transform.
  std::vector<cpu::CellLevel> rasterize(const CellMesh& mesh) {
    const UploadedMesh uploaded = upload(mesh);
    std::vector<cpu::CellLevel> result;
    for (const CellLattice& cells : coverMesh(mesh)) {
      CellStages& on = level(result.size());
      const auto reserve = [&](const ListSizes& lists) {
        on.reserve(cells, uploaded.addresses().triangleCount, lists, false);
      };
      runUntilItFits(on.grid, reserve, [&](Commands& commands) {
        on.grid.record(commands, uploaded.addresses());
        on.distance.record(commands, uploaded.addresses(), on.grid);
      });
      result.emplace_back().grid.cells = cells;
      result.back().squared = downloadBuffer<float>(on.distance.squared());
    }
    return result;
  }

  Buffer<float> rasterDistance(const CellMesh& mesh) {
    std::vector<CellLevelData> data;
    for (const cpu::CellLevel& rasterized : rasterize(mesh)) {
      CellStages& on = level(data.size());
      on.transform.reserve(rasterized.grid.cells.dims);
      data.push_back(on.data());
    }
    DeviceBuffer distance(device(), "distance");
    distance.resize<float>(CellLattice{mesh.dims}.count());
    samples_.reserve(mesh.dims, data);
    run([&](Commands& commands) {
      for (size_t l = 0; l < data.size(); ++l) level(l).transform.record(commands, data[l].squared);
      samples_.record(commands, distance.address());
    });
    return downloadBuffer<float>(distance);
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

  /// Adds the values that the formula in vulkan/stages/distance_transform.h gives.
  TransformResult transformed(const glm::ivec3& dims, const Buffer<float>& squared,
                              const DistanceTransformStage& transform) const {
    TransformResult result{squared.clone(), downloadBuffer<uint32_t>(transform.nearestCells())};
    const CellLattice cells{dims};
    for (size_t p = 0; p < squared.size(); ++p) {
      const uint32_t nearest = result.cells[p];
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
  cpu::CellLevel onTheCpu(const CellStages& on) const {
    TransformResult result =
        transformed(on.grid.lattice().dims, downloadBuffer<float>(on.distance.squared()), on.transform);
    return {toLists(on.grid), std::move(result.squared), std::move(result.cells)};
  }

  std::vector<std::unique_ptr<CellStages>> levels_;
  RefineStage refine_{device()};
  RasterDistanceStage samples_{device()};
};

}  // namespace raymap::vulkan
