#pragma once

#include "command_buffer.h"
#include "face_sides.h"
#include "progress.h"
#include "stage_recorder.h"

namespace raymap::vulkan {

/// The pipeline from the host's mesh to the host's field. Everything runs when the field is finished, or one
/// stage after the other where somebody watches the progress. Keeps its memory between runs: one like the one
/// before allocates nothing, and nothing is read back but the field.
class Backend : public StageRecorder {
 public:
  explicit Backend(Device& device);

  /// Takes the mesh to the device and sizes the field. The references must live until `finish`.
  void begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress, Field& field);
  void voxelGrid();
  void rasterDistance();
  void orientation();
  void closeHoles();
  /// Brings the distances into the mesh's units, and everything asked for to the host.
  void finish();

  /// Bytes that a run will hold, from sizes alone; the lists of the voxel grid, whose length only the device
  /// finds out, come on top.
  static size_t bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options);
  /// Of them those for each triangle.
  static constexpr size_t kBytesPerTriangle = 160;

  /// Share of samples whose six rays disagree.
  double doubtfulShare() const { return doubtfulShare_; }
  /// Which faces were turned, and how well the crossings agree.
  const FaceSides& faceSides() const { return faceSides_; }
  /// The surface that `closeHoles` added.
  const HolePatch& patch() const { return patch_; }
  /// What the device took for each stage of the last run.
  const std::vector<Stats::Stage>& stages() const { return stages_; }
  /// What the last run took by the device's clock from the mesh being there to the field being there: waiting
  /// for the host in between counts, taking either across does not. 0 if it has no timestamps.
  double milliseconds() const { return fieldReady_ - meshReady_; }

 private:
  class FaceTurner;

  void afterStage() override;
  void run();
  /// Runs all that was recorded, and a stage of that name.
  template <class Work>
  void run(const char* name, Work&& work) {
    commands().stage(name, work);
    run();
    continueIn(commandBuffer_.begin());
  }
  /// Reads back how many samples' rays disagree; throws what kept the crossings from being counted.
  double readDoubtfulShare(const char* stage);
  bool growIfFull();
  Extent extentOf(const Mesh& mesh, const Grid& grid, const Options& options) const;
  void reserveResults(const Grid& grid, const Options& options);
  void takeResults();
  void recordPiece(const DeviceBuffer& result, uint64_t first);
  void readBack(const DeviceBuffer& result, void* to, bool isFirstThere = false);

  Device* device_;
  const Mesh* inputMesh_ = nullptr;
  Progress* progress_ = nullptr;
  Field* field_ = nullptr;
  double doubtfulShare_ = 0.0;
  std::optional<double> doubtfulGiven_;  ///< Of the mesh as given, where that was asked for.
  FaceSides faceSides_;
  HolePatch patch_;
  std::vector<Stats::Stage> stages_;
  double meshReady_ = 0.0, fieldReady_ = 0.0;

  CommandBuffer commandBuffer_;
  MeshUpload upload_;
  DeviceBuffer distance_, triangle_, winding_, confidence_;
  DeviceBuffer findings_, piece_;  // For the host.
};

}  // namespace raymap::vulkan
