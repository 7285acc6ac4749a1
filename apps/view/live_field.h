#pragma once

#include <raymap/vulkan.h>

#include <memory>

#include "device_mesh.h"
#include "field_worker.h"
#include "rigid_motion.h"

namespace raymap::view {

/// Settings of the field of a mesh.
struct FieldSettings {
  int resolution = 128;  ///< Samples along the longest side.
  FieldOptions options = {};
};

/// The field that is shown, on the device. It is made anew whenever something about it changes: on the device
/// itself, or on the CPU by another thread, coarsely while things move and finely when they rest.
class LiveField {
 public:
  /// The content and the mesh must outlive it. `mesh` is null if the content is a field.
  LiveField(const Gpu& gpu, const Content& content, DeviceMesh* mesh, bool isOnDevice,
            const MachineOptions& machine);

  /// Records what is to do for these settings at a time. Returns whether the field changed. May wait for the
  /// device if settings changed. With `mayMove`, a rigid motion moves the grid of the field that is there.
  bool record(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving, bool mayMove);

  /// Returns whether there is a field yet.
  bool isReady() const { return hasField_; }
  /// Returns the field, with the numbers of `array`.
  vulkan::FieldBuffer buffer() const;
  /// Returns the array that it has besides distances; `Distance`: none.
  FieldArray array() const { return array_; }
  /// Returns whether its grid has moved since it was made.
  bool isMoved() const { return motion_ != RigidMotion(); }
  const Grid& grid() const { return grid_; }
  /// Returns whether the field is what was asked for last, at full resolution.
  bool isCurrent() const { return isCurrent_; }
  /// Returns whether a finer or newer field is being made.
  bool isBusy() const;
  /// Returns the time that the CPU took for the last field; 0 if the device made it.
  double milliseconds() const { return milliseconds_; }
  /// Returns the bytes of the device's memory that it holds.
  uint64_t bytes() const {
    return distance_.bytes + values_.bytes + leafIndex_.bytes + (generator_ ? generator_->bytes() : 0);
  }
  bool isOnDevice() const { return isOnDevice_; }
  /// Returns the grid of a mesh's field, at full resolution.
  Grid gridFor(const FieldSettings& settings) const;
  /// Returns why there is no new field; empty if nothing is wrong.
  const std::string& error() const { return error_; }

 private:
  bool recordGiven(Frame& frame, FieldArray array);
  bool recordOnDevice(Frame& frame, const FieldWish& wish);
  bool recordFromWorker(Frame& frame, const FieldSettings& settings, const FieldWish& fine, bool isMoving);
  std::optional<RigidMotion> motionTo(const FieldWish& wish, const FieldWish& made) const;
  void take(Frame& frame, MadeField made);
  void upload(Frame& frame, const Field& field, FieldArray array);
  void makeRoom(Frame& frame, size_t samples, Buffer& buffer);

  const Gpu& gpu_;
  const Content& content_;
  DeviceMesh* mesh_;
  bool isOnDevice_;
  std::unique_ptr<vulkan::Generator> generator_;
  std::unique_ptr<FieldWorker> worker_;
  std::optional<FieldWish> wish_;  ///< Settings and pose of the field on the device.
  std::optional<RigidPoses> poses_;
  bool mayMove_ = false;
  RigidMotion motion_;  ///< Motion of the field's pose to the one that is shown.
  Buffer distance_, values_, leafIndex_;
  FieldArray array_ = FieldArray::Distance, given_ = FieldArray::Distance;  ///< `given_`: asked for last.
  Grid grid_ = {};
  double clampDistance_ = 0.0;
  bool hasField_ = false, isCurrent_ = false;
  int liveResolution_ = 64;  ///< Resolution that keeps up with what moves.
  double milliseconds_ = 0.0;
  std::string error_;
};

}  // namespace raymap::view
