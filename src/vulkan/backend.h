#pragma once

#include <raymap/generate.h>

#include "cell_distance.h"
#include "cell_levels.h"
#include "cell_mesh.h"
#include "command_buffer.h"
#include "crossings.h"
#include "distance_transform.h"
#include "exact_distance.h"
#include "progress.h"
#include "raster_distance.h"
#include "ray_map.h"
#include "refine.h"
#include "sign.h"
#include "surface_tree.h"
#include "voxel_grid.h"
#include "winding_dipoles.h"
#include "winding_harmonic.h"
#include "winding_paths.h"
#include "winding_rays.h"

namespace raymap::vulkan {

/// The device's twin of every stage of pipeline.h. Stages record commands; they run when the field is
/// finished, or one after the other where somebody watches the progress. Keeps its memory between runs: one
/// like the one before allocates nothing.
class Backend {
 public:
  explicit Backend(Device& device);

  /// Takes the mesh to the device and sizes the field. The references must live until `finish`.
  void begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress, Field& field);
  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void exactDistance();
  void crossings();
  void rayMap();
  void winding();
  void closeHoles();
  void sign();
  /// Brings the distances into the mesh's units, and everything asked for to the host.
  void finish();

  /// Bytes that a run will hold, from sizes alone; the lists of the voxel grid, whose length only the device
  /// finds out, come on top.
  static size_t bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options);

  /// Share of samples whose six rays disagree.
  double doubtfulShare() const { return doubtfulShare_; }
  /// What the device took for each stage of the last run.
  const std::vector<Stats::Stage>& stages() const { return stages_; }
  /// What the last run took by the device's clock from the mesh being there to the field being there: waiting
  /// for the host in between counts, taking either across does not. 0 if it has no timestamps.
  double milliseconds() const { return fieldReady_ - meshReady_; }

 private:
  /// What the paper's distances need of one lattice.
  struct Level {
    explicit Level(Device& device) : grid(device), distance(device), raster(device), transform(device) {}
    VoxelGrid grid;
    CellDistance distance;
    RasterDistance raster;
    DistanceTransform transform;
  };
  /// A result on its way to the host.
  struct Result {
    DeviceBuffer device, host;
  };

  /// Where somebody watches the progress, or may cancel, stages run one by one.
  template <class Work>
  void stage(const char* name, Work&& work) {
    commands_->stage(name, work);
    if (!options_->progress) return;
    run();
    commands_ = commandBuffer_.begin();
  }
  template <class Part>
  void stageThatGrows(const char* name, Part Level::*part);
  void run();
  void coverMesh();
  CellRuns::Triangles cellTriangles() const;
  Result makeResult(const std::string& name);
  void reserveStages();
  void reserveResults();
  void recordSurfaceTree();
  void recordPaths();
  void recordHarmonic();
  static VkDeviceAddress addressOf(const Result& result);
  void readBack(Result& result);
  void takeResults();
  bool hasSign() const { return options_->sign != SignMode::None; }

  Device* device_;
  const Mesh* inputMesh_ = nullptr;
  const Grid* grid_ = nullptr;
  const Options* options_ = nullptr;
  Field* field_ = nullptr;
  double doubtfulShare_ = 0.0;
  std::vector<Stats::Stage> stages_;
  double meshReady_ = 0.0, fieldReady_ = 0.0;

  CommandBuffer commandBuffer_;
  std::optional<Commands> commands_;
  CellMesh mesh_;
  SurfaceTree surfaceTree_;
  ExactDistance exactDistance_;
  std::vector<CellLattice> lattices_;
  std::vector<std::unique_ptr<Level>> levels_;  // at least as many
  Refine refine_;
  RasterSamples rasterSamples_;
  Crossings crossings_;
  RayMap rayMap_;
  WindingRays windingRays_;
  WindingPaths windingPaths_;
  WindingHarmonic windingHarmonic_;
  WindingDipoles windingDipoles_;
  Sign sign_;
  Result distance_, triangle_, winding_, confidence_;
  DeviceBuffer crossingsStatus_, doubtful_;
};

}  // namespace raymap::vulkan
