#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "cpu/cells/cell_levels.h"
#include "cpu/distance/surface_tree.h"
#include "cpu/sign/crossings.h"
#include "cpu/sign/ray_map.h"
#include "cpu/sign/winding.h"
#include "cpu/sign/winding_dipoles.h"
#include "method/cell_mesh.h"
#include "method/pipeline.h"

namespace raymap::cpu {

/// CPU backend: runs every stage of method/pipeline.h. Keeps its memory between runs.
class Backend {
 public:
  Backend() = default;
  /// Makes the tree and its dipoles in those of the caller.
  Backend(SurfaceTree& tree, WindingDipoles& dipoles) : surfaceTree_(tree), windingDipoles_(dipoles) {}

  /// Sets the job of the next run. Without `frames`, the numbers of samples and triangles decide where the
  /// tree has them.
  void setJob(const Job& job, std::optional<Frames> frames = {});
  /// Takes a job and runs all stages. Throws `Error(Memory)` if that may need more than the options allow.
  Stats run(const Job& job, std::optional<Frames> frames = {});

  const FieldOptions& options() const { return job_->options; }
  template <class Work>
  void stage(const char* name, Work&& work) {
    job_->progress.stage(name, work);
  }

  /// Converts the mesh into cell units and sizes the field.
  void begin();
  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void exactDistance();
  void crossings();
  void rayMap();
  void winding(SignMode mode);
  void windingDipoles();
  void sign();
  void finish();
  /// Returns true: memory grows as the stages need it.
  static bool complete() { return true; }

  const Model& mesh() const { return job_->mesh; }
  Progress& progress() { return job_->progress; }
  double spacing() const { return job_->grid.spacing; }
  /// Returns the share of samples whose six rays disagree.
  double doubtfulShare() const { return doubtfulShare_; }

  FaceSides& faceSides() { return faceSides_; }
  DoubleSidedFaces doubleSidedFaces();
  void turnFaces(const Turns& turns);
  double misfit() const;
  bool contradictsParity();
  std::span<const float> rises();
  std::span<const float> parityRises();
  NearSides nearSides();

  HolePatch& patch() { return patch_; }
  std::vector<MissingEdge> missingEdges();
  std::vector<float> windingAt(std::span<const glm::vec3> points);
  const CellMesh& cellMesh() const { return mesh_; }
  size_t bytesLeft() const;
  static size_t patchTreeBytes(size_t triangles) { return SurfaceTree::bytesNeeded(triangles); }
  void addPatch();

  /// Leaves the tree with the faces of the last run as given, but one of each group of double-sided ones.
  /// Its dipoles stay if they are of that tree.
  void restoreTree();

  /// Returns the number of bytes held, with the field and the mesh's copy.
  size_t bytes() const;
  /// Returns the most bytes that the run may hold.
  size_t mostBytes() const;
  /// Returns the number of bytes that the run holds with the field if all rays agree, from sizes alone.
  /// Layers of surface add to it. A run asks for more when it knows that rays disagree.
  size_t bytesNeeded() const;

 private:
  /// Throws `Error(Memory)` if these bytes are too many beside those held. The message has `why`.
  void ask(size_t more, const char* why) const;
  /// Returns the tree for distances. Builds it on first use.
  const SurfaceTree& surfaceTree();
  /// Returns the tree for winding numbers. Its normals are those of the faces as the sign takes them.
  const SurfaceTree& turnedSurfaceTree();
  bool leaveOutDoubleSided();
  const RimLattices& findRims(SignMode mode);
  /// Returns whether the sign takes the faces as `turnFaces` turned them, and not as given.
  bool areTurned() const { return mesh_.triangles.data() == turnedTriangles_.data(); }
  void measureSides(float farSides, Buffer<float>* wholeness = nullptr);
  /// Returns the buffer for the closest triangles, or null if the options do not ask for them.
  Buffer<uint32_t>* triangles() { return options().triangle ? &job_->field.triangle : nullptr; }
  Buffer<float>& windingBuffer() { return options().winding ? job_->field.winding : winding_; }
  const Buffer<float>& windingBuffer() const { return options().winding ? job_->field.winding : winding_; }

  std::optional<Job> job_;
  Frames frames_ = Frames::Stored;

  CellMesh mesh_;
  Buffer<glm::uvec3> turnedTriangles_;
  std::vector<CellLevel> levels_;  // lattices of the paper's distance stages
  SurfaceTree ownTree_, &surfaceTree_ = ownTree_;
  DoubleSidedFaces doubleSided_;  // Each group is one face in the tree.
  Turns turns_;                   // Since the tree was built.
  bool hasSurfaceTree_ = false;
  enum class TreeTurns { Unasked, None, Some } treeTurns_ = TreeTurns::Unasked;  // those made in the tree
  Crossings crossings_;
  bool hasCrossings_ = false;
  Turns crossedTurns_;         // The turns that the crossings are counted with; empty if all are as given.
  ChangedFaces changedFaces_;  // Since the crossings were counted.
  RayMap rayMap_;
  Winding windingSolver_;
  WindingDipoles ownDipoles_, &windingDipoles_ = ownDipoles_;
  double doubtfulShare_ = 0.0;
  bool mustFit_ = false;  // Whether numbers do not all follow from rims, whichever faces are reversed.
  RimLattices rims_;
  bool areRimsFound_ = false;  // Whether `rims_` has those of the faces as the sign takes them.
  Buffer<float> rises_, wholeness_;
  FaceSides faceSides_;
  Buffer<float> winding_;
  HolePatch patch_;
  SurfaceTree patchTree_;
};

static_assert(HostBackend<Backend>);

}  // namespace raymap::cpu
