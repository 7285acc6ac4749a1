#pragma once

#include <raymap/options.h>
#include <raymap/vulkan.h>

#include <array>
#include <functional>
#include <utility>

#include "vulkan/device/commands.h"
#include "vulkan/device/scratch_memory.h"
#include "vulkan/runtime/findings.h"
#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/cell_mesh.h"
#include "vulkan/stages/close_holes.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/exact_distance.h"
#include "vulkan/stages/face_search.h"
#include "vulkan/stages/finish.h"
#include "vulkan/stages/orientation.h"
#include "vulkan/stages/raster_distance.h"
#include "vulkan/stages/ray_map.h"
#include "vulkan/stages/refine.h"
#include "vulkan/stages/surface_tree.h"
#include "vulkan/stages/winding_dipoles.h"
#include "vulkan/stages/winding_doubts.h"
#include "vulkan/stages/winding_harmonic.h"
#include "vulkan/stages/winding_paths.h"
#include "vulkan/stages/winding_rays.h"
#include "vulkan/stages/winding_rims.h"

namespace raymap::vulkan {

/// Returns whether rays may come before the distances and keep their memory: in larger grids, steps and waits
/// for the host take a small share of the time. Beside lists of cells, rays take 16 bytes a sample
/// more.
constexpr bool areFewSamples(size_t samples, DistanceMode mode) {
  return samples <= (mode == DistanceMode::Exact ? size_t{1} << 21 : size_t{1} << 19);
}

/// Records the GPU twin of every stage of method/pipeline.h, from a mesh on the device to its field there.
/// `Backend` transfers both from and to the host, `FrameBackend` leaves both on the device.
class StageRecorder {
 public:
  const FieldOptions& options() const { return *options_; }

  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void rayMap() {
    if (!hasRays_) rayMap_.record(*commands_, crossings_.lines());
  }
  void sign() {}  // A part of `finish`.

 protected:
  /// Capacities to reserve.
  struct Extent {
    uint32_t vertices = 0;
    uint32_t triangles = 0;
    glm::ivec3 dims{0};
    DistanceMode distance = DistanceMode::Exact;
    SignMode sign = SignMode::Harmonic;
    bool hasWinding = false;  ///< Whether the results always include a buffer for the winding number.
    bool turnsFaces = false;
    bool closesHoles = false;
    bool findsRims = false;       ///< Whether the host looks for rims.
    bool castsRaysFirst = false;  ///< Whether rays come before the distances and keep their memory.
    bool searchesFaces = false;   ///< Whether the device searches for rims and faces that lie on others.
    /// Cells that the paper's distances search: `coverBounds` of meshes that reach at most `outside` beyond
    /// the grid.
    std::vector<CellLattice> lattices;
    double outside = 0.0;  ///< Samples beyond the grid.
    std::array<ListSizes, kMostLevels> lists{};
  };
  /// Addresses of the results, one value per sample.
  struct Results {
    VkDeviceAddress distance = 0;
    VkDeviceAddress triangle = 0;    ///< 0: not requested.
    VkDeviceAddress winding = 0;     ///< 0: not requested.
    VkDeviceAddress confidence = 0;  ///< 0: not requested.
  };

  void recordCrossings() {
    if (!hasRays_) crossings_.record(*commands_, mesh_.mesh());
  }
  /// The winding numbers of `SignMode::Harmonic` after `recordRays`, if some rays disagree: from rims, or as
  /// the field that fits all crossings.
  void recordRays(SignMode mode) {
    if (!std::exchange(hasRays_, false))
      windingRays_.record(*commands_, crossings_.lines(), mode, results_.winding);
  }
  void recordWinding(SignMode mode);
  void recordDoubts();
  void recordDipoles(WindingDipolesStage::Looks looks);

  explicit StageRecorder(Device& device);

  /// Reserves the capacities. All previously recorded work must have completed.
  void reserve(const Extent& extent);
  const Extent& extent() const { return extent_; }
  /// Returns whether the lists had enough capacity.
  bool fits(const Findings& findings) const;
  /// Reserves the capacity that the lists need. All previously recorded work must have completed.
  void grow(const Findings& findings);

  /// Sets the input of the following stages. Grid and options must outlive them. The reserved capacities must
  /// cover the options.
  void start(const Commands& commands, const Grid& grid, const FieldOptions& options);
  /// Sets the addresses of the results; called after `reserve`.
  void setResults(const Results& results);
  void recordMesh(const CellMeshStage::Source& source);
  /// Records the tree beside the rays, if these come first.
  void recordTreeWithRays();
  void recordExactDistance();
  void recordFinish();
  /// Copies the findings to all targets that have a buffer.
  void recordFindings(std::initializer_list<BufferRange> targets);
  /// Returns the status that the findings mean, for a run over the extent.
  Status describe(const Findings& findings) const;

  bool hasSign() const { return extent_.sign != SignMode::None; }
  bool isExact() const { return extent_.distance == DistanceMode::Exact; }
  size_t sampleCount() const { return CellLattice{extent_.dims}.count(); }

  Commands& commands() { return *commands_; }
  /// Sets the command buffer to record into from now on.
  void continueIn(const Commands& commands) { commands_ = commands; }
  const Grid& grid() const { return *grid_; }
  /// Returns the tree of the current mesh; records its construction first if the mesh has none.
  const SurfaceTreeStage& surfaceTree();
  OrientationStage::Fields orientationFields() const;

  Device* device_;
  Results results_;
  ScratchMemory scratch_;  // Declared before the members that use it.
  CellMeshStage mesh_;
  FaceSearchStage faceSearch_;
  CrossingsStage crossings_;
  OrientationStage orientation_;
  WindingDoubtsStage windingDoubts_;
  WindingDipolesStage windingDipoles_;
  WindingRimsStage windingRims_;
  CloseHolesStage closeHoles_;

 private:
  /// Returns the place of scratch memory from which on nothing holds rays.
  size_t reserveSign();
  void reserveCells();
  void recordTree() { surfaceTree_.record(*commands_, mesh_.mesh(), extent_.dims); }
  bool isRaster() const { return extent_.distance == DistanceMode::Raster; }
  /// Records what only needs the mesh: `chain`, and beside it the rays and the search for faces, if rays come
  /// first.
  void recordWithRays(const std::function<void()>& chain);
  std::optional<Error> errorOf(const Findings& findings) const;

  std::optional<Commands> commands_;
  const Grid* grid_ = nullptr;
  const FieldOptions* options_ = nullptr;
  Extent extent_;
  bool hasSurfaceTree_ = false;
  bool hasRays_ = false;  // Until `recordRays` asks for them.
  SurfaceTreeStage surfaceTree_;
  ExactDistanceStage exactDistance_;
  std::vector<std::unique_ptr<CellStages>> levels_;  // At least as many as lattices.
  RefineStage refine_;
  RasterDistanceStage rasterDistance_;
  RayMapStage rayMap_;
  WindingRaysStage windingRays_;
  WindingPathsStage windingPaths_;
  WindingHarmonicStage windingHarmonic_;
  FinishStage finish_;
  DeviceBuffer windingNumber_;  // Used if the results have no buffer for it.
};

}  // namespace raymap::vulkan
