#include "live_field.h"

#include <raymap/error.h>
#include <raymap/grid.h>

#include <algorithm>
#include <cmath>

namespace raymap::view {

namespace {

constexpr double kLiveMilliseconds = 60.0;  // Time of a field while things move.
constexpr int kLeastResolution = 24;

/// Returns the array that is wanted besides distances; `Distance`: none.
FieldArray arrayOf(const FieldOptions& options) {
  return options.winding      ? FieldArray::Winding
         : options.confidence ? FieldArray::Confidence
                              : FieldArray::Distance;
}

}  // namespace

LiveField::LiveField(const Gpu& gpu, const Content& content, DeviceMesh* mesh, bool isOnDevice,
                     const MachineOptions& machine)
    : gpu_(gpu), content_(content), mesh_(mesh), isOnDevice_(isOnDevice) {
  if (content.field) return;
  if (isOnDevice_) {
    generator_ = std::make_unique<vulkan::Generator>(gpu.handles());
    return;
  }
  MachineOptions onCpu = machine;
  onCpu.device = "cpu";
  worker_ = std::make_unique<FieldWorker>(content, onCpu);
}

Grid LiveField::gridFor(const FieldSettings& settings) const {
  if (content_.grid) return *content_.grid;
  return fitGrid(content_.bounds,
                 {.resolution = settings.resolution, .thickness = settings.options.thickness});
}

bool LiveField::isBusy() const {
  return worker_ && worker_->wish();
}

bool LiveField::record(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving) {
  isCurrent_ = true;
  if (content_.field) return recordGiven(frame, arrayOf(settings.options));
  if (isOnDevice_) return recordOnDevice(frame, settings, seconds);
  const bool isNew = recordFromWorker(frame, settings, seconds, isMoving);
  isCurrent_ = wish_ && wish_->grid == gridFor(settings) && wish_->options == settings.options &&
               wish_->seconds == seconds;
  return isNew;
}

void LiveField::makeRoom(Frame& frame, size_t samples, Buffer& buffer) {
  if (buffer.bytes >= samples * sizeof(float)) return;
  if (buffer.handle) frame.keep(std::move(buffer));  // Earlier frames may still draw it.
  buffer = gpu_.makeBuffer(samples * sizeof(float));
}

void LiveField::upload(Frame& frame, const Field& field, FieldArray array) {
  const auto take = [&](const raymap::Buffer<float>& numbers, Buffer& to) {
    makeRoom(frame, numbers.size(), to);
    frame.upload(std::as_bytes(std::span(numbers.data(), numbers.size())), to);
  };
  take(field.distance, distance_);
  const raymap::Buffer<float>& numbers = array == FieldArray::Winding ? field.winding : field.confidence;
  array_ = numbers.empty() ? FieldArray::Distance : array;
  if (array_ != FieldArray::Distance) take(numbers, values_);
  grid_ = field.grid;
  clampDistance_ = field.clampDistance;
  hasField_ = true;
}

bool LiveField::recordGiven(Frame& frame, FieldArray array) {
  if (hasField_ && given_ == array) return false;
  given_ = array;
  upload(frame, *content_.field, array);
  return true;
}

bool LiveField::recordOnDevice(Frame& frame, const FieldSettings& settings, double seconds) {
  const FieldWish wish{.grid = gridFor(settings), .options = settings.options, .seconds = seconds};
  if (wish_ == wish) return false;
  const bool isRoomy = wish_ && wish_->grid.dims == wish.grid.dims &&
                       wish_->options.distance == wish.options.distance &&
                       wish_->options.sign == wish.options.sign;
  wish_ = wish;
  try {
    if (!isRoomy) {
      gpu_.waitIdle();
      generator_->reserve({.vertices = mesh_->buffers().vertexCount,
                           .triangles = mesh_->triangleCount(),
                           .dims = wish.grid.dims,
                           .distance = wish.options.distance,
                           .sign = wish.options.sign});
    }
    const FieldArray array = arrayOf(wish.options);
    vulkan::Target target;
    const auto makeTarget = [&](vulkan::BufferRange& range, Buffer& buffer) {
      makeRoom(frame, wish.grid.sampleCount(), buffer);
      range = buffer.range();
    };
    makeTarget(target.distance, distance_);
    if (array == FieldArray::Winding) makeTarget(target.winding, values_);
    if (array == FieldArray::Confidence) makeTarget(target.confidence, values_);
    generator_->record(frame.commands(), mesh_->buffers(), wish.grid, wish.options, target);
    array_ = array;
    error_.clear();
  } catch (const Error& error) {
    error_ = error.what();
    return false;
  }
  grid_ = wish.grid;
  clampDistance_ = wish.options.band * wish.grid.spacing;
  hasField_ = true;
  return true;
}

void LiveField::take(Frame& frame, MadeField made) {
  error_ = made.error;
  wish_ = made.wish;
  if (!made.error.empty()) return;
  upload(frame, made.field, arrayOf(made.wish.options));
  milliseconds_ = made.stats.milliseconds;
  // Time grows with the square of the resolution, near enough.
  const int resolution = std::max({grid_.dims.x, grid_.dims.y, grid_.dims.z});
  const double factor = std::sqrt(kLiveMilliseconds / std::max(milliseconds_, 1.0));
  liveResolution_ = std::max(kLeastResolution, int(resolution * std::clamp(factor, 0.5, 1.5)));
}

bool LiveField::recordFromWorker(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving) {
  FieldSettings live = settings;
  live.resolution = std::min(liveResolution_, settings.resolution);
  const FieldWish fine{.grid = gridFor(settings), .options = settings.options, .seconds = seconds};
  const FieldWish coarse{.grid = gridFor(live), .options = settings.options, .seconds = seconds};
  std::optional<MadeField> made = worker_->take();
  const bool isNew = made && made->error.empty();
  if (made) take(frame, std::move(*made));
  if (const std::optional<FieldWish> making = worker_->wish()) {
    // A coarse field that is late is better than none.
    const bool isLate = *making != fine && making->grid.dims == fine.grid.dims;
    if (isLate && live.resolution < settings.resolution) worker_->cancel();
    return isNew;
  }
  if (wish_ == fine) return isNew;
  const bool isRough = wish_ && wish_->options == fine.options && wish_->seconds == seconds;
  if (!isMoving && isRough)
    worker_->ask(fine);
  else if (!isRough)
    worker_->ask(coarse);
  return isNew;
}

}  // namespace raymap::view
