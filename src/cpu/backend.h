#pragma once

#include <vector>

#include "cell_level.h"
#include "cell_mesh.h"
#include "close_holes.h"
#include "crossings.h"
#include "face_sides.h"
#include "progress.h"
#include "ray_map.h"
#include "surface_tree.h"
#include "winding.h"
#include "winding_dipoles.h"

namespace raymap {

/// The CPU's twin of every stage of pipeline.h. Holds what lies between the mesh and the field, and keeps
/// that memory between runs.
class CpuBackend {
 public:
  /// Takes the mesh into cell units and sizes the field. The references must live until `finish`.
  void begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress, Field& field);
  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void exactDistance();
  void crossings();
  void rayMap();
  void winding();
  void orientation();
  void windingDipoles();
  void closeHoles();
  void sign();
  /// Brings the distances into the mesh's units.
  void finish();

  /// Share of samples whose six rays disagree.
  double doubtfulShare() const { return doubtfulShare_; }
  /// Which faces were turned, and how well the crossings agree.
  const FaceSides& faceSides() const { return faceSides_; }
  /// The surface that `closeHoles` added.
  const HolePatch& patch() const { return patch_; }
  /// Bytes held, the field not counted.
  size_t bytes() const;

  /// Bytes that a run will hold at most, the field counted, from sizes alone.
  static size_t bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options);

 private:
  /// Built when a stage first asks for it.
  const SurfaceTree& surfaceTree();
  Buffer<float>& windingBuffer() { return options_->winding ? field_->winding : winding_; }

  const Mesh* inputMesh_ = nullptr;
  const Options* options_ = nullptr;
  Progress* progress_ = nullptr;
  Field* field_ = nullptr;
  size_t memoryLimit_ = 0;

  CellMesh mesh_;
  Buffer<glm::uvec3> turnedTriangles_;
  std::vector<CellLevel> levels_;  // of the paper's distance stages
  SurfaceTree surfaceTree_;
  bool hasSurfaceTree_ = false;
  Crossings crossings_;
  RayMap rayMap_;
  Winding windingSolver_;
  WindingDipoles windingDipoles_;
  WindingSummary windingSummary_;
  double doubtfulShare_ = 0.0;
  FaceSides faceSides_;
  Buffer<float> winding_;
  HolePatch patch_;
  SurfaceTree patchTree_;
};

}  // namespace raymap
