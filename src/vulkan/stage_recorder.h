#pragma once

#include <raymap/generate.h>

#include <array>

#include "cell_distance.h"
#include "cell_levels.h"
#include "cell_mesh.h"
#include "close_holes.h"
#include "commands.h"
#include "crossings.h"
#include "distance_transform.h"
#include "exact_distance.h"
#include "findings.h"
#include "orientation.h"
#include "raster_distance.h"
#include "ray_map.h"
#include "refine.h"
#include "scratch_memory.h"
#include "sign.h"
#include "surface_tree.h"
#include "voxel_grid.h"
#include "winding_dipoles.h"
#include "winding_harmonic.h"
#include "winding_paths.h"
#include "winding_rays.h"

namespace raymap::vulkan {

/// Records the device's twin of every stage of pipeline.h, from a mesh on the device to its field there. What
/// derives from it brings both there and back: `Backend` for the host, `FrameBackend` for others on the
/// device.
class StageRecorder {
 public:
  virtual ~StageRecorder() = default;

  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void exactDistance();
  void crossings();
  void rayMap();
  void winding();
  /// Where the host does not see the mesh, its faces are taken as they point.
  void orientation();
  void windingDipoles();
  void sign();

 protected:
  /// What there is to be room for.
  struct Extent {
    uint32_t vertices = 0;
    uint32_t triangles = 0;
    glm::ivec3 dims{0};
    DistanceMode distance = DistanceMode::Exact;
    SignMode sign = SignMode::Harmonic;
    bool hasWinding = false;  ///< Results always come with a place for the winding number.
    bool turnsFaces = false;
    bool closesHoles = false;
    /// What the paper's distances search: `coverBounds` of meshes that reach no farther than `outside`.
    std::vector<CellLattice> lattices;
    double outside = 0.0;  ///< In samples, beyond the grid.
    std::array<ListSizes, kMostLevels> lists{};
  };
  /// Where the results lie, of every sample.
  struct Results {
    VkDeviceAddress distance = 0;
    VkDeviceAddress triangle = 0;    ///< 0: not asked for.
    VkDeviceAddress winding = 0;     ///< Likewise.
    VkDeviceAddress confidence = 0;  ///< Likewise.
  };

  explicit StageRecorder(Device& device);

  /// Nothing recorded before may still have to run.
  void reserve(const Extent& extent);
  const Extent& extent() const { return extent_; }
  /// Whether the lists had the room they needed.
  bool fits(const Findings& findings) const;
  /// Makes room for lists that did not. Nothing recorded before may still have to run.
  void grow(const Findings& findings);

  /// What the stages work on from now on; grid and options must live as long. Options for as much as was
  /// reserved.
  void begin(const Commands& commands, const Grid& grid, const Options& options, const Results& results);
  void recordMesh(const CellMesh::Source& source);
  // For turning faces: the harmonic field of the mesh that is there, how badly it fits the crossings, and how
  // much it, or the parity in its place, rises along the faces.
  void recordSolve();
  void recordMisfit();
  void recordRises();
  void recordParityRises();
  const OrientationKernels& orientationOf() const { return orientation_; }
  // For closing holes: where surface is missing, the winding numbers at some points, and distances to a
  // patch.
  void recordMissingEdges();
  void recordNumbersAt(std::span<const glm::vec3> points);
  void recordPatch(const HolePatch& patch);
  CloseHoles& closeHolesOf() { return closeHoles_; }
  /// Distances in the mesh's units.
  void recordFinish();
  void recordFindings(VkBuffer to, VkDeviceSize offset);
  /// What findings mean, for a run over the extent.
  Status describe(const Findings& findings) const;

  template <class Work>
  void stage(const char* name, Work&& work) {
    commands_->stage(name, work);
    afterStage();
  }
  virtual void afterStage() {}

  bool hasSign() const { return extent_.sign != SignMode::None; }
  bool isExact() const { return extent_.distance == DistanceMode::Exact; }
  size_t sampleCount() const { return CellLattice{extent_.dims}.count(); }

  Commands& commands() { return *commands_; }
  /// Into another command buffer from now on.
  void continueIn(const Commands& commands) { commands_ = commands; }
  const Grid& grid() const { return *grid_; }
  const Options& options() const { return *options_; }

 private:
  /// What the paper's distances need of one lattice.
  struct Level {
    Level(Device& device, ScratchMemory* scratch)
        : grid(device, scratch),
          distance(device, scratch),
          raster(device, scratch),
          transform(device, scratch) {}
    VoxelGrid grid;
    CellDistance distance;
    RasterDistance raster;
    DistanceTransform transform;
  };

  void reserveSign();
  void reserveCells();
  bool isRaster() const { return extent_.distance == DistanceMode::Raster; }
  /// Of the mesh as it is by now, if it is not there.
  const SurfaceTree& surfaceTree();
  WindingFields windingFields() const;
  OrientationKernels::Fields orientationFields() const;
  std::optional<Error> errorOf(const Findings& findings) const;

  Device* device_;
  std::optional<Commands> commands_;
  const Grid* grid_ = nullptr;
  const Options* options_ = nullptr;
  Extent extent_;
  Results results_;
  ScratchMemory scratch_;  // Before what lies there.
  CellMesh mesh_;
  bool hasSurfaceTree_ = false;
  SurfaceTree surfaceTree_;
  ExactDistance exactDistance_;
  std::vector<std::unique_ptr<Level>> levels_;  // At least as many as lattices.
  Refine refine_;
  RasterSamples rasterSamples_;
  Crossings crossings_;
  RayMap rayMap_;
  WindingRays windingRays_;
  WindingPaths windingPaths_;
  WindingHarmonic windingHarmonic_;
  OrientationKernels orientation_;
  WindingDipoles windingDipoles_;
  CloseHoles closeHoles_;
  Sign sign_;
  DeviceBuffer winding_;  // Where nobody else has a place for it.
};

}  // namespace raymap::vulkan
