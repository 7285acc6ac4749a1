#pragma once

// Fields made and used on a GPU, with no way through the host: the mesh in buffers of yours, the work
// recorded into a command buffer of yours, the field in a buffer or 3D image of yours. docs/vulkan.md and
// examples/animated show how.
//
// The one public header with Vulkan's types, and not part of raymap.h. Of Vulkan it needs declarations only:
// who uses volk, or wants VK_NO_PROTOTYPES, includes or defines that first. raymap itself opens the loader
// (libvulkan.so.1) at run time.

#include <raymap/animation.h>
#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/render.h>
#include <vulkan/vulkan_core.h>

#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace raymap::vulkan {

/// A device and one of its queues.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;  ///< Of the command buffers to record into: it must be able to compute.
  VkQueue queue = VK_NULL_HANDLE;
};

/// Switches on the features that a device must be made with, and leaves all others alone. Beside them it
/// needs Vulkan 1.3, for the instance too, and no extension.
void requireFeatures(VkPhysicalDeviceFeatures& v10, VkPhysicalDeviceVulkan12Features& v12,
                     VkPhysicalDeviceVulkan13Features& v13);

/// A buffer of the caller's from some byte on.
struct BufferRange {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;  ///< A multiple of 4.
};

/// A mesh on the device. Both buffers need VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, and memory allocated
/// with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT. They are only read.
struct MeshBuffers {
  BufferRange vertices;        ///< Three floats each; the position of a vertex is `origin` plus these.
  uint32_t vertexStride = 12;  ///< Bytes from one to the next, a multiple of 4.
  uint32_t vertexCount = 0;
  BufferRange triangles;  ///< Three 32-bit indices each, tightly packed.
  uint32_t triangleCount = 0;
  glm::dvec3 origin{0.0};
};

/// Where a frame's results go: distances into the buffer `distance` or into `image`, one of the two; the rest
/// as wanted. Of every sample, x fastest, as in `Field`. Buffers need
/// VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT and memory allocated with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT.
struct Target {
  BufferRange distance;  ///< Floats.
  /// A 3D image as large as the grid, of the format in `Room`, with VK_IMAGE_USAGE_TRANSFER_DST_BIT. What it
  /// held is lost, whatever its layout was.
  VkImage image = VK_NULL_HANDLE;
  VkImageLayout imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;  ///< That it is left in.
  BufferRange triangle;    ///< 32-bit numbers; not with `DistanceMode::Raster`.
  BufferRange winding;     ///< Floats; not with `SignMode::None`.
  BufferRange confidence;  ///< Likewise.
  /// `kStatusWords` 32-bit numbers for `Generator::status`, for frames whose status must not be lost to the
  /// next one's. Needs VK_BUFFER_USAGE_TRANSFER_DST_BIT instead.
  BufferRange status;
};

/// How long the lists are that the paper's distances make (§3.1); only the device finds out.
struct ListSizes {
  uint64_t rows = 0;     ///< Rows of cells that the triangles' bounds touch.
  uint64_t entries = 0;  ///< Pairs of a cell and a triangle in it.
};

/// What a generator makes room for.
struct Room {
  uint32_t vertices = 0;  ///< At most, in any frame,
  uint32_t triangles = 0;
  glm::ivec3 dims{0};  ///< but all grids are of these dims; their origin and spacing may change.
  DistanceMode distance = DistanceMode::Exact;
  SignMode sign = SignMode::Harmonic;
  VkFormat image = VK_FORMAT_UNDEFINED;  ///< Of targets that are images: R32_SFLOAT or R16_SFLOAT.
  /// How many samples beyond the grid triangles may reach. All distances but `Exact`, which needs no such
  /// bound, look no further.
  double outside = 0.0;
  ListSizes lists;  ///< At least, as in `Status::lists`; raymap guesses what suits fine meshes.
};

/// What the device found out while it made a field.
struct Status {
  /// What keeps the field from being that of the whole mesh, if anything: Input for triangles left out or out
  /// of reach, Memory for lists that outgrew their room, Unsupported beyond what the device can number.
  std::optional<Error> error;
  uint32_t triangles = 0;      ///< Left out: with an index out of range or a vertex that is not finite,
  uint32_t outside = 0;        ///< or, at least in part, beyond `Room::outside`.
  ListSizes lists;             ///< Needed; where `error` is Memory, `reserve` with these.
  double doubtfulShare = 0.0;  ///< Share of samples whose six rays disagree.
};

inline constexpr size_t kStatusWords = 18;

/// Records the making of fields. Used by one thread at a time. Keep it, and what it was given, until the
/// device has done what was recorded.
class Generator {
 public:
  /// On a device of its own, "vulkan" or "vulkan:K" as in `Options::device`. Throws `Error(Unsupported)`.
  explicit Generator(std::string_view device = "vulkan");
  /// On a device of the caller's, made with `requireFeatures`, which must outlive the generator.
  explicit Generator(const DeviceHandles& device);
  ~Generator();
  Generator(Generator&&) noexcept;
  Generator& operator=(Generator&&) noexcept;

  /// What it works on. A device of its own is there for the caller to use, but goes with the generator.
  const DeviceHandles& device() const;

  /// Allocates everything and makes all kernels. The device must have done what was recorded before; and
  /// those command buffers are of no use any more. Memory that suffices is kept. Throws `Error`: Usage,
  /// Unsupported, Memory.
  void reserve(const Room& room);

  /// Records a frame: outside a render pass, into a command buffer of a family that can compute. Allocates
  /// nothing on the device, submits nothing, waits for nothing; may be called while earlier frames run.
  /// `options.distance` and `options.sign` are those reserved; the others may change from frame to frame;
  /// those about the host (threads, device, memory, progress), and which results are wanted, do not count:
  /// `target` says that.
  ///
  /// It begins with a barrier that waits for all commands before it on the queue and ends with one that lets
  /// all after it, and the host, see the results. So frames on one queue share the generator's memory without
  /// more ado, and nothing else is needed there; from one queue to another it takes a semaphore and, if these
  /// are of different families and the resources not of VK_SHARING_MODE_CONCURRENT, a transfer of ownership.
  /// Frames of one generator must not run at once on two queues. The compute pipeline and push constants that
  /// were bound before are not afterwards.
  ///
  /// Faces are taken as they point, by `Orientation::Auto` too: turning them takes a host that looks.
  ///
  /// Indices out of range and vertices that are not finite do no harm: their triangles are left out, and
  /// `status` says so. Throws `Error`: Usage, or Unsupported for `closeHoles` and `Orientation::Repair`,
  /// having recorded nothing.
  void record(VkCommandBuffer commands, const MeshBuffers& mesh, const Grid& grid, const Options& options,
              const Target& target);

  /// Of the frame that the device completed last; none may be running. That of an unfinished frame says
  /// nothing.
  Status status() const;
  /// Of the frame whose `Target::status` this was.
  Status status(std::span<const uint32_t, kStatusWords> words) const;

  /// Device memory held.
  uint64_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A skin and a pose of its joints, as in `AnimatedMesh`. Buffers as for `MeshBuffers`.
struct SkinBuffers {
  BufferRange rest;      ///< Three floats a vertex, tightly packed.
  BufferRange joints;    ///< Four 16-bit numbers of matrices a vertex
  BufferRange weights;   ///< and four floats; or neither, if the first matrix moves all vertices.
  BufferRange matrices;  ///< A `JointMatrix` a joint; like the weights at a multiple of 16 bytes.
  uint32_t vertexCount = 0;
  uint32_t jointCount = 0;
};

/// Records what `posed` does on the CPU. Barriers, threads and lifetime are as of `Generator`.
class Skinner {
 public:
  explicit Skinner(const DeviceHandles& device);
  ~Skinner();
  Skinner(Skinner&&) noexcept;
  Skinner& operator=(Skinner&&) noexcept;

  /// Writes three floats a vertex to `vertices`, good for `MeshBuffers`. A vertex that follows a joint out of
  /// range becomes not a number, which a generator reports. Throws `Error(Usage)`, having recorded
  /// nothing.
  void record(VkCommandBuffer commands, const SkinBuffers& skin, const BufferRange& vertices);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A signed field on the device, as a generator leaves it.
struct FieldBuffer {
  BufferRange distance;  ///< Floats, x fastest, in the mesh's units.
  Grid grid;
  double band = 0.0;  ///< As `Field::band`, in the mesh's units.
};

/// Records the drawing of pictures, as `renderField` draws them. Barriers, threads and lifetime are as of
/// `Generator`.
class Renderer {
 public:
  explicit Renderer(const DeviceHandles& device);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Writes 32 bits a pixel to `pixels`, rows from the top: sRGB red in the lowest byte, then green, blue and
  /// 255, as in VK_FORMAT_R8G8B8A8_SRGB. `options.frame` must be given: where the shape is, only the device
  /// knows. Options about the host (threads, device, progress) do not count. Throws `Error`: Usage,
  /// Unsupported, having recorded nothing.
  void record(VkCommandBuffer commands, const FieldBuffer& field, const RenderOptions& options,
              const BufferRange& pixels);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::vulkan
