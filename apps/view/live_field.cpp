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
  if (content.isField()) return;
  if (content.animated) poses_.emplace(*content.animated);
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

vulkan::FieldBuffer LiveField::buffer() const {
  vulkan::FieldBuffer buffer{.distance = distance_.range(),
                             .grid = grid_,
                             .clampDistance = clampDistance_,
                             .rotation = motion_.rotation,
                             .translation = motion_.translation};
  if (array_ != FieldArray::Distance) buffer.values = values_.range();
  if (content_.field && content_.field->narrow)
    buffer.band = {.leafIndex = leafIndex_.range(),
                   .inside = content_.field->narrow->inside,
                   .outside = content_.field->narrow->outside};
  return buffer;
}

bool LiveField::isBusy() const {
  return worker_ && worker_->wish();
}

/// Returns the motion by which a field that was made serves for a wish, whatever its grid; none if it does
/// not.
std::optional<RigidMotion> LiveField::motionTo(const FieldWish& wish, const FieldWish& made) const {
  if (made.options != wish.options) return {};
  if (made.seconds == wish.seconds) return RigidMotion();
  if (!poses_ || !error_.empty()) return {};
  const std::optional<RigidMotion> motion = poses_->between(made.seconds, wish.seconds);
  return mayMove_ || motion == RigidMotion() ? motion : std::nullopt;
}

bool LiveField::record(Frame& frame, const FieldSettings& settings, double seconds, bool isMoving,
                       bool mayMove) {
  isCurrent_ = true;
  mayMove_ = mayMove;
  if (content_.isField()) return recordGiven(frame, arrayOf(settings.options));
  const FieldWish wish{.grid = gridFor(settings), .options = settings.options, .seconds = seconds};
  const bool isNew =
      isOnDevice_ ? recordOnDevice(frame, wish) : recordFromWorker(frame, settings, wish, isMoving);
  const std::optional<RigidMotion> motion = wish_ ? motionTo(wish, *wish_) : std::nullopt;
  motion_ = motion.value_or(RigidMotion());
  if (!isOnDevice_) isCurrent_ = motion && wish_->grid == wish.grid;
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
  clampDistance_ = field.clamp();
  hasField_ = true;
}

bool LiveField::recordGiven(Frame& frame, FieldArray array) {
  if (hasField_ && given_ == array) return false;
  given_ = array;
  if (content_.field->narrow && leafIndex_.bytes == 0) {
    const std::vector<uint32_t> index = vulkan::packLeafIndex(*content_.field);
    leafIndex_ = gpu_.makeBuffer(index.size() * sizeof(uint32_t));
    frame.upload(std::as_bytes(std::span(index)), leafIndex_);
  }
  upload(frame, *content_.field, array);
  return true;
}

bool LiveField::recordOnDevice(Frame& frame, const FieldWish& wish) {
  if (wish_ && wish_->grid == wish.grid && motionTo(wish, *wish_)) return false;
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

bool LiveField::recordFromWorker(Frame& frame, const FieldSettings& settings, const FieldWish& fine,
                                 bool isMoving) {
  FieldSettings live = settings;
  live.resolution = std::min(liveResolution_, settings.resolution);
  FieldWish coarse = fine;
  coarse.grid = gridFor(live);
  std::optional<MadeField> made = worker_->take();
  const bool isNew = made && made->error.empty();
  if (made) take(frame, std::move(*made));
  if (const std::optional<FieldWish> making = worker_->wish()) {
    // A coarse field that is late is better than none.
    const bool isLate =
        making->grid.dims == fine.grid.dims && !(making->grid == fine.grid && motionTo(fine, *making));
    if (isLate && live.resolution < settings.resolution) worker_->cancel();
    return isNew;
  }
  const bool isThere = wish_ && motionTo(fine, *wish_);  // At any resolution.
  if (isThere && wish_->grid == fine.grid) return isNew;
  // A finer field is worth its time while nothing moves, or if it can move along.
  if (!isThere)
    worker_->ask(coarse);
  else if (!isMoving || wish_->seconds != fine.seconds)
    worker_->ask(fine);
  return isNew;
}

}  // namespace raymap::view
