#pragma once

#include <raymap/vulkan.h>

#include <memory>

#include "device_mesh.h"
#include "field_worker.h"

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
  /// device if settings changed.
  bool record(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving);

  /// Returns whether there is a field yet.
  bool isReady() const { return hasField_; }
  /// Returns the field, with the numbers of `array`.
  vulkan::FieldBuffer buffer() const {
    return {distance_.range(), grid_, clampDistance_,
            array_ == FieldArray::Distance ? vulkan::BufferRange{} : values_.range()};
  }
  /// Returns the array that it has besides distances; `Distance`: none.
  FieldArray array() const { return array_; }
  const Grid& grid() const { return grid_; }
  /// Returns whether the field is what was asked for last, at full resolution.
  bool isCurrent() const { return isCurrent_; }
  /// Returns whether a finer or newer field is being made.
  bool isBusy() const;
  /// Returns the time that the CPU took for the last field; 0 if the device made it.
  double milliseconds() const { return milliseconds_; }
  bool isOnDevice() const { return isOnDevice_; }
  /// Returns why there is no new field; empty if nothing is wrong.
  const std::string& error() const { return error_; }

 private:
  Grid gridFor(const FieldSettings& settings) const;
  bool recordGiven(Frame& frame, FieldArray array);
  bool recordOnDevice(Frame& frame, const FieldSettings& settings, double seconds);
  bool recordFromWorker(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving);
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
  Buffer distance_, values_;
  FieldArray array_ = FieldArray::Distance, given_ = FieldArray::Distance;  ///< `given_`: asked for last.
  Grid grid_ = {};
  double clampDistance_ = 0.0;
  bool hasField_ = false, isCurrent_ = false;
  int liveResolution_ = 64;  ///< Resolution that keeps up with what moves.
  double milliseconds_ = 0.0;
  std::string error_;
};

}  // namespace raymap::view
