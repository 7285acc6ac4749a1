#pragma once

#include "method/backend_concepts.h"
#include "vulkan/runtime/stage_recorder.h"
#include "vulkan/stages/field_image.h"

namespace raymap::vulkan {

/// Pipeline from a mesh on the device to its field there, recorded into any command buffer.
class FrameBackend : public StageRecorder {
 public:
  struct Frame {
    Commands commands;
    CellMeshStage::Source mesh;
    Results results;  ///< Without `distance`, a buffer of ours holds the distances for the image.
    VkImage image = VK_NULL_HANDLE;
    VkImageLayout imageLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    BufferRange status;
  };

  explicit FrameBackend(Device& device);

  /// Reserves capacities. All previously recorded work must have completed.
  void reserve(const Room& room);
  /// Sets what the next run of the pipeline records. Grid and options must live until then.
  void setFrame(const Frame& frame, const Grid& grid, const FieldOptions& options);

  /// Records a frame without triangles: every sample has this distance.
  void recordFar(Commands commands, const Target& target, float distance);

  template <class Work>
  void stage(const char*, Work&& work) {
    work();
  }
  void begin();
  void exactDistance() {
    recordTreeWithRays();
    recordExactDistance();
  }
  void crossings() { recordCrossings(); }
  /// Takes no rims, for the host does not know the mesh.
  void winding(SignMode mode) {
    recordRays(mode);
    recordWinding(mode);
  }
  void windingDipoles() {
    recordDoubts();
    recordDipoles({});
  }
  void finish();
  /// Always true: `status` reports whether the capacities sufficed.
  static bool complete() { return true; }

  /// Returns the status of the last frame that ran.
  Status status() const { return describe(findings_.mapped<Findings>().front()); }
  /// Returns the status of the frame with these findings.
  Status status(const Findings& findings) const { return describe(findings); }

 private:
  std::optional<Frame> frame_;
  FieldImageStage image_;
  DeviceBuffer findings_;
};

static_assert(raymap::Backend<FrameBackend> && !HostBackend<FrameBackend>);

}  // namespace raymap::vulkan
