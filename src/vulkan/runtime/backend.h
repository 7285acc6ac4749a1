#pragma once

#include "method/pipeline.h"
#include "vulkan/device/command_buffer.h"
#include "vulkan/runtime/stage_recorder.h"

namespace raymap::vulkan {

/// Pipeline from the host's mesh to the host's field. The device runs the recorded work when the field is
/// complete or the host reads something; with a progress callback it runs every stage separately. Keeps its
/// memory between runs: a run like the one before allocates nothing.
class Backend : public StageRecorder, private RecordingListener {
 public:
  explicit Backend(Device& device);

  /// Sets the input of the next run.
  void setJob(const Job& job);

  /// Runs a stage, timed by both clocks.
  template <class Work>
  void stage(const char* name, Work&& work) {
    progress().stage(name, [&] {
      startStage(name);
      work();
      stopStage();
      if (job_->machine.progress) run();
    });
  }
  /// Uploads the mesh and sizes the field.
  void begin();
  /// Records nothing in a small grid: `winding` then records the distances, after the rays.
  void exactDistance();
  /// In a small grid, with the tree and the search for faces.
  void crossings();
  /// Lets the host look for rims if rays disagree.
  void winding(SignMode mode);
  void windingDipoles();
  void finish() { recordFinish(); }
  bool complete();
  /// Copies the results into the field. Throws the error that kept the device from computing it.
  void readResults();

  const Model& mesh() const { return job_->mesh; }
  Progress& progress() { return job_->progress; }
  double spacing() const { return job_->grid.spacing; }
  double doubtfulShare();

  FaceSides& faceSides() { return faceSides_; }
  const DoubleSidedFaces& doubleSidedFaces();
  void turnFaces(const Turns& turns);
  double misfit();
  bool contradictsParity() const { return orientation_.contradictsParity(); }
  std::span<const float> rises();
  std::span<const float> parityRises();
  NearSides nearSides();

  HolePatch& patch() { return patch_; }
  std::vector<MissingEdge> missingEdges();
  std::vector<float> windingAt(std::span<const glm::vec3> points);
  const CellMesh& cellMesh();
  size_t bytesLeft() const;
  static size_t patchTreeBytes(size_t triangles) { return SurfaceTreeStage::bytesNeeded(triangles); }
  void addPatch();

  /// Returns the times of the last run's stages by the device's clock.
  const std::vector<Stats::Stage>& stages() const { return stages_; }
  /// Returns the milliseconds by the device's clock from the uploaded mesh to the complete field. The host's
  /// work in between is included, the transfers are not. 0 if the device has no timestamps.
  double milliseconds() const { return fieldReady_ - meshReady_; }

 protected:
  /// Names the stage of what is recorded from now on.
  virtual void startStage(const char* name);
  virtual void stopStage();

 private:
  void searchFaces();
  size_t submitPart();
  void recordDueDistance();
  void searchRims(SignMode mode);
  /// Runs all recorded work, and meanwhile `work` on the host.
  template <class Work>
  void runBeside(Work&& work);
  /// Reads the share of doubtful samples, and does `work` on the host until it is there. The device goes on
  /// with distances that are due.
  template <class Work>
  double countDoubtful(Work&& work);
  void run();
  /// Returns commands that record into our command buffer from its beginning.
  Commands newCommands();
  void onMuchWork() override { run(); }
  void onProgress(double done) override;
  Extent extentOf(const PackedMesh& mesh, const Grid& grid, const FieldOptions& options) const;
  void reserveResults();
  std::span<const float> measureRises(float farSides);
  /// Returns the bytes of a result that are copied at once.
  uint64_t partBytes(const DeviceBuffer& result) const;
  void recordPart(const DeviceBuffer& result, uint64_t first);
  void readBack(const DeviceBuffer& result, void* to, bool isFirstThere = false);

  std::optional<Job> job_;
  const char* openStage_ = nullptr;
  size_t faceSearchPart_ = 0;  ///< Part of the command buffer that searches for faces.
  bool isDistanceDue_ = false;
  std::optional<double> doubtfulShare_;  ///< Empty until it is read.
  RimLattices rims_;
  std::optional<DoubleSidedFaces> doubleSided_;
  Turns turns_;  ///< Empty while the faces are as given.
  std::vector<float> rises_;
  FaceSides faceSides_;
  CellMesh cellMesh_;
  Buffer<glm::uvec3> turnedTriangles_;  ///< Those of `cellMesh_`, unless they are as given.
  HolePatch patch_;
  std::vector<Stats::Stage> stages_;
  double meshReady_ = 0.0, fieldReady_ = 0.0;

  MeshUpload upload_;
  DeviceBuffer distance_, triangle_, winding_, confidence_;
  DeviceBuffer findings_, piece_;  // Read by the host.
  CommandBuffer commandBuffer_;    // Destroyed first: it waits for what the device still does.
};

static_assert(HostBackend<Backend>);

}  // namespace raymap::vulkan
