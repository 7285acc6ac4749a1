#include <cmath>
#include <cstring>
#include <string>

#include "base/require.h"
#include "base/text.h"
#include "method/check_options.h"
#include "method/device_name.h"
#include "method/far_field.h"
#include "method/pipeline.h"
#include "vulkan/device/buffer_range.h"
#include "vulkan/device/command_buffer.h"
#include "vulkan/runtime/frame_backend.h"

namespace raymap::vulkan {

namespace {

void checkRoom(const Room& room) {
  if (room.sign == SignMode::Exact)
    throw Error(ErrorCode::Unsupported, "the rims of a mesh that only the device sees cannot be found");
  constexpr uint32_t kMostVertices = uint32_t{1} << 29, kMostTriangles = uint32_t{1} << 29;
  const auto outOf = [](uint32_t count, uint32_t most) { return count == 0 || count > most; };
  require(!outOf(room.vertices, kMostVertices) && !outOf(room.triangles, kMostTriangles),
          "cannot reserve " + std::to_string(room.vertices) + " vertices and " +
              std::to_string(room.triangles) + " triangles; each number must be 1 to 2^29");
  const glm::dvec3 dims(room.dims);
  require(room.dims.x > 0 && room.dims.y > 0 && room.dims.z > 0, "the grid has no samples");
  require(dims.x * dims.y * dims.z < double(kNoTriangle),
          "the grid has more than 4294967294 samples; use a lower resolution");
  require(room.outside >= 0.0 && room.outside <= 1e9,
          "triangles may reach 0 to 1e9 samples beyond the grid, not " + numberText(room.outside));
}

void checkMesh(const MeshBuffers& mesh, const Room& room) {
  require(mesh.triangleCount > 0,
          "the mesh has no triangles; allow empty meshes for a field that is far everywhere");
  require(mesh.vertices.buffer && mesh.triangles.buffer, "the mesh has no buffer of vertices or triangles");
  require(mesh.vertexCount > 0, "the mesh has no vertices");
  require(mesh.vertexCount <= room.vertices && mesh.triangleCount <= room.triangles,
          "the mesh has " + std::to_string(mesh.vertexCount) + " vertices and " +
              std::to_string(mesh.triangleCount) + " triangles, the capacity is " +
              std::to_string(room.vertices) + " and " + std::to_string(room.triangles) + "; reserve more");
  require(mesh.vertexStride >= sizeof(glm::vec3) && mesh.vertexStride % sizeof(float) == 0,
          "vertices are " + std::to_string(mesh.vertexStride) +
              " bytes apart; it must be 12 or more, and a multiple of 4");
  require(uint64_t{mesh.vertexStride} * mesh.vertexCount <= uint64_t{1} << 33,
          "the vertices spread over more than 8 GiB; pack them more tightly");
}

void checkTarget(const Target& target, const Room& room) {
  const bool hasImage = room.image != VK_FORMAT_UNDEFINED;
  require(
      (target.image != VK_NULL_HANDLE) == hasImage && (target.distance.buffer != VK_NULL_HANDLE) != hasImage,
      hasImage
          ? "the capacity was reserved for images: the target must be an image, not a buffer of distances"
          : "the capacity was reserved for buffers of distances: the target must be a buffer, not an image");
  require(!target.triangle.buffer || room.distance != DistanceMode::Raster,
          "the raster distance does not find closest triangles; use another distance");
  require(room.sign != SignMode::None || (!target.winding.buffer && !target.confidence.buffer),
          "without a sign there are no winding numbers and confidences");
  require(target.status.offset % sizeof(uint32_t) == 0, "the status must lie at a multiple of 4 bytes");
}

}  // namespace

struct Generator::Impl {
  template <class... Args>
  explicit Impl(Args&&... args) : device(std::forward<Args>(args)...), backend(device), trial(device) {}

  void reserve(const Room& wanted);
  void record(const FrameBackend::Frame& frame, const Grid& grid, const FieldOptions& options);
  VkDeviceAddress addressOf(const BufferRange& range) const;

  Device device;
  FrameBackend backend;
  CommandBuffer trial;
  std::optional<Room> room;
};

void Generator::Impl::reserve(const Room& wanted) {
  checkRoom(wanted);
  room.reset();
  backend.reserve(wanted);
  room = wanted;
  // Kernels are made when they are first recorded, so a frame is recorded that never runs.
  record(
      {.commands = trial.begin(), .mesh = {.vertexCount = room->vertices, .triangleCount = room->triangles}},
      {.dims = room->dims, .spacing = 1.0}, {.distance = room->distance, .sign = room->sign});
}

void Generator::Impl::record(const FrameBackend::Frame& frame, const Grid& grid,
                             const FieldOptions& options) {
  backend.setFrame(frame, grid, options);
  runPipeline(backend);
}

VkDeviceAddress Generator::Impl::addressOf(const BufferRange& range) const {
  return vulkan::addressOf(device.handle(), range, "a buffer of the mesh or the target");
}

namespace {

DeviceOptions named(std::string_view name) {
  const std::optional<DeviceName> device = parseDeviceName(name);
  if (!device || device->kind != DeviceName::Kind::Vulkan)
    throw Error(device ? ErrorCode::Unsupported : ErrorCode::Usage,
                "there is no Vulkan device '" + std::string(name) + "'; use vulkan or vulkan:K");
  return {.index = device->index};
}

DeviceHandles checked(const DeviceHandles& device) {
  require(device.instance && device.physical && device.device,
          "the generator needs the instance, the physical device and the device, but one of them is null");
  return device;
}

}  // namespace

Generator::Generator(std::string_view device) : impl_(std::make_unique<Impl>(named(device))) {}
Generator::Generator(const DeviceHandles& device) : impl_(std::make_unique<Impl>(checked(device))) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

const DeviceHandles& Generator::device() const {
  return notMoved(impl_).device.handles();
}

void Generator::reserve(const Room& room) {
  notMoved(impl_).reserve(room);
}

void Generator::record(VkCommandBuffer commands, const MeshBuffers& mesh, const Grid& grid,
                       const FieldOptions& options, const Target& target) {
  require(commands != VK_NULL_HANDLE, "no command buffer is given");
  require(notMoved(impl_).room.has_value(), "no capacity is reserved; call reserve first");
  const Room& room = *notMoved(impl_).room;
  checkOptions(grid, options);
  require(grid.dims == room.dims, "the grid's dims are not the reserved ones");
  require(options.distance == room.distance && options.sign == room.sign,
          "the distance or the sign is not the reserved one");
  if (options.closeHoles)
    throw Error(ErrorCode::Unsupported, "holes of a mesh that only the device sees cannot be closed");
  if (options.orientation == Orientation::Repair)
    throw Error(ErrorCode::Unsupported, "the faces of a mesh that only the device sees cannot be turned");
  if (options.thickness > 0.0)
    throw Error(ErrorCode::Unsupported,
                "a thickness is for fields on the host only; subtract half of it from an unsigned field");
  checkTarget(target, room);
  const Commands into(commands, notMoved(impl_).device.pipelineLayout(), nullptr);
  if (mesh.triangleCount == 0 && options.allowEmpty)
    return notMoved(impl_).backend.recordFar(into, target, farDistance(options, grid.spacing));
  checkMesh(mesh, room);
  notMoved(impl_).record({.commands = into,
                          .mesh = {.positions = notMoved(impl_).addressOf(mesh.vertices),
                                   .stride = static_cast<uint32_t>(mesh.vertexStride / sizeof(float)),
                                   .triangles = notMoved(impl_).addressOf(mesh.triangles),
                                   .vertexCount = mesh.vertexCount,
                                   .triangleCount = mesh.triangleCount,
                                   .origin = mesh.origin},
                          .results = {.distance = notMoved(impl_).addressOf(target.distance),
                                      .triangle = notMoved(impl_).addressOf(target.triangle),
                                      .winding = notMoved(impl_).addressOf(target.winding),
                                      .confidence = notMoved(impl_).addressOf(target.confidence)},
                          .image = target.image,
                          .imageLayout = target.imageLayout,
                          .status = target.status},
                         grid, options);
}

Status Generator::status() const {
  return notMoved(impl_).room ? notMoved(impl_).backend.status() : Status{};
}

Status Generator::status(std::span<const std::byte> written) const {
  require(written.size() == statusBytes(), "a status has " + std::to_string(statusBytes()) + " bytes, not " +
                                               std::to_string(written.size()) + "; see statusBytes");
  require(notMoved(impl_).room.has_value(),
          "no capacity is reserved, so there is no frame; call reserve first");
  Findings findings;
  std::memcpy(&findings, written.data(), sizeof findings);
  return notMoved(impl_).backend.status(findings);
}

size_t statusBytes() {
  return sizeof(Findings);
}

uint64_t Generator::bytes() const {
  return notMoved(impl_).device.heldMemory();
}

}  // namespace raymap::vulkan
