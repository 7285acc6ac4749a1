#pragma once

// Fields made and used on a GPU without a copy through the host. The mesh lies in the caller's buffers, the
// work is recorded into the caller's command buffer, and the field goes to the caller's buffer or 3D image.
// docs/vulkan.md and examples/animated show how.
//
// With raymap/vulkan_device.h, the one public header with Vulkan's types, and not part of raymap.h. It needs
// Vulkan's declarations only. Programs that use volk or VK_NO_PROTOTYPES include or define that first. raymap
// opens the loader (libvulkan.so.1) itself, at run time.

#include <raymap/animation.h>
#include <raymap/error.h>
#include <raymap/narrow_band.h>
#include <raymap/options.h>
#include <raymap/picture.h>
#include <raymap/vulkan_device.h>
#include <vulkan/vulkan_core.h>

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace raymap::vulkan {

/// A mesh on the device, which is only read. Both buffers need VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, and
/// memory allocated with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT.
struct MeshBuffers {
  BufferRange vertices = {};   ///< Three floats each; the position of a vertex is `origin` plus these.
  uint32_t vertexStride = 12;  ///< Bytes from one vertex to the next, a multiple of 4.
  uint32_t vertexCount = 0;
  BufferRange triangles = {};  ///< Three 32-bit indices each, tightly packed.
  uint32_t triangleCount = 0;
  glm::dvec3 origin{0.0};  ///< In the mesh's units.
};

/// Destinations of a frame's results: distances in either the buffer `distance` or `image`, the others as
/// wanted. Each holds one value per sample, x fastest, as in `Field`. Buffers need
/// VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT and memory allocated with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT.
struct Target {
  BufferRange distance = {};  ///< Floats, in the mesh's units.
  /// 3D image with the dims of the grid and the format of `Room::image`, with
  /// VK_IMAGE_USAGE_TRANSFER_DST_BIT. Its contents before are lost, whatever its layout was.
  VkImage image = VK_NULL_HANDLE;
  VkImageLayout imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;  ///< Layout after the frame.
  BufferRange triangle = {};    ///< 32-bit indices; not with `DistanceMode::Raster`.
  BufferRange winding = {};     ///< Floats; not with `SignMode::None`.
  BufferRange confidence = {};  ///< Floats; not with `SignMode::None`.
  /// `statusBytes()` bytes for `Generator::status`, for frames whose status must outlive the next frame's.
  /// Needs VK_BUFFER_USAGE_TRANSFER_DST_BIT instead.
  BufferRange status = {};
};

/// Capacities that a generator reserves.
struct Room {
  uint32_t vertices = 0;   ///< Most vertices of any frame.
  uint32_t triangles = 0;  ///< Most triangles of any frame.
  glm::ivec3 dims{0};      ///< Dims of all grids; their origin and spacing may change.
  DistanceMode distance = DistanceMode::Exact;
  SignMode sign = SignMode::Harmonic;    ///< Not `Exact`: the host does not know the rims.
  VkFormat image = VK_FORMAT_UNDEFINED;  ///< Format of targets that are images: R32_SFLOAT or R16_SFLOAT.
  /// How far triangles may reach beyond the grid, in samples. Distances other than `Exact` look no further;
  /// `Exact` needs no such bound.
  double outside = 0.0;
  ListSizes lists = {};  ///< Least lengths, as in `Status::lists`; by default a guess that suits fine meshes.
};

/// Findings of the device while it made a field.
struct Status {
  /// Reason why the field is not that of the whole mesh, if it is not. Input: triangles were left out or out
  /// of reach. Memory: lists outgrew their capacity. Unsupported: more than the device can number.
  std::optional<Error> error = {};
  uint32_t triangles = 0;  ///< Number of triangles left out: an index out of range, or a vertex not finite.
  uint32_t outside = 0;    ///< Number of triangles at least partly beyond `Room::outside`.
  ListSizes lists = {};    ///< Lengths that were needed; if `error` is Memory, reserve these.
  double doubtfulShare = 0.0;  ///< Share of samples whose six rays disagree.
};

/// Returns the size of the status that a frame writes to `Target::status`. It may grow with a version.
RAYMAP_API size_t statusBytes();

/// Records the making of fields. Used by one thread at a time. The generator, and all that it was given, must
/// outlive the device's work on what was recorded.
class RAYMAP_API Generator {
 public:
  /// Opens a device of its own: "vulkan" or "vulkan:K" as in `MachineOptions::device`. Throws `Error`: Usage
  /// for another name, Unsupported if there is none.
  explicit Generator(std::string_view device = "vulkan");
  /// Runs on the caller's device, made with `requireFeatures`, which must outlive the generator.
  explicit Generator(const DeviceHandles& device);
  ~Generator();
  Generator(Generator&&) noexcept;
  Generator& operator=(Generator&&) noexcept;

  /// Returns the device. The caller may use the generator's own device too; it is destroyed with the
  /// generator.
  const DeviceHandles& device() const;

  /// Allocates all memory and makes all kernels. All previously recorded work must have completed, and those
  /// command buffers become invalid. Memory that suffices is kept. Throws `Error`: Usage, Unsupported,
  /// Memory.
  void reserve(const Room& room);

  /// Records a frame into a command buffer that supports compute, outside a render pass.
  ///
  /// It allocates no device memory, submits nothing and waits for nothing. Earlier frames may still run.
  /// `options.distance` and `options.sign` must be the reserved ones; the others may change from frame to
  /// frame. Options that ask for results are ignored: `target` decides them.
  ///
  /// The frame begins with a barrier that waits for all earlier commands on the queue. It ends with one that
  /// makes the results visible to all later commands and to the host. Frames on one queue therefore share the
  /// generator's memory safely. Results used on another queue need a semaphore; between queue families also
  /// an ownership transfer, unless the resources are VK_SHARING_MODE_CONCURRENT. Frames of one generator must
  /// not run at once on two queues. The bound compute pipeline and push constants are lost.
  ///
  /// A mesh without triangles needs no buffers if `options.allowEmpty`. The buffers of `target` then need
  /// VK_BUFFER_USAGE_TRANSFER_DST_BIT besides.
  ///
  /// Faces are taken as they point, by `Orientation::Auto` too: the host would have to read back to reverse
  /// them. Triangles with an index out of range or a vertex that is not finite are left out, and `status`
  /// says so.
  ///
  /// Throws `Error`: Usage, or Unsupported for `closeHoles`, `thickness` and `Orientation::Repair`. Nothing
  /// is recorded then.
  void record(VkCommandBuffer commands, const MeshBuffers& mesh, const Grid& grid,
              const FieldOptions& options, const Target& target);

  /// Returns the status of the frame that the device completed last. No frame may be running.
  Status status() const;
  /// Returns the status of the frame that wrote these bytes to its `Target::status`. Throws `Error(Usage)` if
  /// they are not `statusBytes()`.
  Status status(std::span<const std::byte> written) const;

  /// Returns the bytes of device memory held.
  uint64_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A skin and a pose of its joints, as in `AnimatedMesh`. Buffers need the same usage as in `MeshBuffers`.
struct SkinBuffers {
  BufferRange rest = {};      ///< Rest positions: three floats per vertex, tightly packed.
  BufferRange joints = {};    ///< Four 16-bit indices of matrices per vertex; none: all follow the first.
  BufferRange weights = {};   ///< Four floats per vertex; none if `joints` is none. Offset a multiple of 16.
  BufferRange matrices = {};  ///< One `JointMatrix` per joint. Offset a multiple of 16.
  uint32_t vertexCount = 0;
  uint32_t jointCount = 0;
};

/// Records skinning, as `posed` does it on the CPU; morphs are left to the caller. Barriers, threads and
/// lifetime are those of `Generator`.
class RAYMAP_API Skinner {
 public:
  explicit Skinner(const DeviceHandles& device);
  ~Skinner();
  Skinner(Skinner&&) noexcept;
  Skinner& operator=(Skinner&&) noexcept;

  /// Writes three floats per vertex to `vertices`, as `MeshBuffers` wants them. A vertex that follows a joint
  /// out of range becomes NaN, which a generator reports. Throws `Error(Usage)`; nothing is recorded then.
  void record(VkCommandBuffer commands, const SkinBuffers& skin, const BufferRange& vertices);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// How a renderer finds the leaves of a narrow band on the device, and the widths of the band.
struct BandBuffer {
  BufferRange leafIndex = {};          ///< The words of `packLeafIndex`; none: the field is dense.
  double inside = 0.0, outside = 0.0;  ///< As in `Field`.
};

/// Returns 32-bit words by which a renderer finds the leaves of a narrow band. A renderer trusts them, and
/// that the leaves are there: others make it read anywhere. Throws `Error(Usage)` if the band is not valid,
/// and `Error(Unsupported)` if it has more than 2^31 - 1 samples.
RAYMAP_API std::vector<uint32_t> packLeafIndex(const Field& band);

/// A signed field on the device, as a generator leaves it, or a narrow band.
struct FieldBuffer {
  BufferRange distance = {};  ///< Floats, x fastest, in the mesh's units.
  Grid grid = {};
  double clampDistance = 0.0;  ///< `Field::clampDistance`, in the mesh's units.
  /// Motion of the shape since the field was made: the grid's point p is drawn at `rotation` * p +
  /// `translation`, in the mesh's units. A shape that moves rigidly needs no new field.
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 translation{0.0};
  /// Samples of `RenderOptions::array`. If that is `Distance`, those of a second field on the same grid, as
  /// `RenderOptions::other` shows them; none: there is no second one.
  BufferRange values = {};
  /// Set if the field is a narrow band. Then `distance` and `values` hold 512 samples per leaf, as the arrays
  /// of a `Field` do. A second field is not drawn beside it.
  BandBuffer band = {};
};

/// Destination of a picture.
struct PictureTarget {
  /// 32 bits per pixel, rows from the top: sRGB red in the lowest byte, then green, blue and 255, as in
  /// VK_FORMAT_R8G8B8A8_SRGB.
  BufferRange pixels = {};
  /// A float per pixel, if wanted: the distance from the eye to the nearest that the pixel shows, in the
  /// mesh's units, or the largest float.
  BufferRange depth = {};
  /// A `uint32_t`, if wanted. The steps that rays take from the eye are added to it: of each pixel, those of
  /// its mean ray, rounded. Counting needs a kernel of its own, which is made when it is needed first.
  BufferRange steps = {};
  int firstRow = 0;  ///< First row to draw; a large picture may be drawn in several frames.
  int rows = 0;      ///< Number of rows to draw; 0 = all from the first on.
};

/// Records pictures, drawn as by `renderField`. Barriers, threads and lifetime are those of `Generator`.
class RAYMAP_API Renderer {
 public:
  explicit Renderer(const DeviceHandles& device);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Draws a picture, or rows of it. `options.frame` is required, as only the device knows where the shape
  /// is; it and all other options stay where they are when the grid moves. Throws `Error`: Usage,
  /// Unsupported; nothing is recorded then.
  void record(VkCommandBuffer commands, const FieldBuffer& field, const RenderOptions& options,
              const PictureTarget& target);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::vulkan
