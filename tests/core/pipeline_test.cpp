// The order of the stages, as a backend that computes nothing sees it.

#include "method/pipeline.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace raymap {
namespace {

using Names = std::vector<std::string>;

/// Records which stages run and which functions they call.
class FakeBackend {
 public:
  explicit FakeBackend(const FieldOptions& options) : options_(options) {}

  const FieldOptions& options() const { return options_; }
  template <class Work>
  void stage(const char* name, Work&& work) {
    stages.emplace_back(name);
    work();
  }
  void begin() { calls.emplace_back("begin"); }
  void voxelGrid() { calls.emplace_back("voxelGrid"); }
  void cellDistance() { calls.emplace_back("cellDistance"); }
  void distanceTransform() { calls.emplace_back("distanceTransform"); }
  void refine() { calls.emplace_back("refine"); }
  void rasterDistance() { calls.emplace_back("rasterDistance"); }
  void exactDistance() { calls.emplace_back("exactDistance"); }
  void crossings() { calls.emplace_back("crossings"); }
  void rayMap() { calls.emplace_back("rayMap"); }
  void winding(SignMode mode) {
    EXPECT_EQ(mode, modeBeforeOrientation(options_));
    calls.emplace_back("winding");
  }
  void windingDipoles() { calls.emplace_back("windingDipoles"); }
  void sign() { calls.emplace_back("sign"); }
  void finish() { calls.emplace_back("finish"); }
  bool complete() { return runsLeft-- == 0; }

  Names stages, calls;
  int runsLeft = 0;  ///< Number of runs whose lists outgrow their memory.

 private:
  FieldOptions options_;
};
static_assert(Backend<FakeBackend>);

/// A backend whose results the host can read: there are no faces to reverse and no holes to close.
class FakeHostBackend : public FakeBackend {
 public:
  using FakeBackend::FakeBackend;

  const Model& mesh() const { return mesh_; }
  Progress& progress() { return progress_; }
  double spacing() const { return 1.0; }
  double doubtfulShare() const { return 0.0; }
  FaceSides& faceSides() { return faceSides_; }
  DoubleSidedFaces doubleSidedFaces() const { return {}; }
  void turnFaces(const Turns&) { ADD_FAILURE(); }
  double misfit() const { return 0.0; }
  bool contradictsParity() const { return false; }
  std::span<const float> rises() const { return {}; }
  std::span<const float> parityRises() const { return {}; }
  NearSides nearSides() const { return {}; }
  HolePatch& patch() { return patch_; }
  std::vector<MissingEdge> missingEdges() const { return {}; }
  std::vector<float> windingAt(std::span<const glm::vec3>) const { return {}; }
  const CellMesh& cellMesh() const { return cellMesh_; }
  size_t bytesLeft() const { return 0; }
  static size_t patchTreeBytes(size_t) { return 0; }
  void addPatch() { ADD_FAILURE(); }

 private:
  Mesh triangle_{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  Model mesh_{triangle_};
  Progress progress_;
  FaceSides faceSides_;
  HolePatch patch_;
  CellMesh cellMesh_;
};
static_assert(HostBackend<FakeHostBackend>);

template <class B = FakeHostBackend>
Names stagesOf(const FieldOptions& options) {
  B backend(options);
  runPipeline(backend);
  return backend.stages;
}

TEST(Pipeline, RunsTheStagesInThePapersOrder) {
  FieldOptions options{.distance = DistanceMode::Cell, .sign = SignMode::Paths};
  const Names stages{"begin",       "voxel_grid", "cell_distance", "distance_transform",
                     "refine",      "crossings",  "ray_map",       "winding",
                     "orientation", "sign",       "finish"};
  EXPECT_EQ(stagesOf(options), stages);
  options.distance = DistanceMode::Neighbours;
  EXPECT_EQ(stagesOf(options), stages);
}

TEST(Pipeline, RunsTheStagesOfEveryDistance) {
  EXPECT_EQ(stagesOf({.distance = DistanceMode::Exact, .sign = SignMode::None}),
            (Names{"begin", "exact_distance", "finish"}));
  EXPECT_EQ(stagesOf({.distance = DistanceMode::Raster, .sign = SignMode::None}),
            (Names{"begin", "raster_distance", "distance_transform", "refine", "finish"}));
}

TEST(Pipeline, RunsTheStagesOfEverySign) {
  for (const SignMode sign :
       {SignMode::Exact, SignMode::Paths, SignMode::Evolution, SignMode::Rays, SignMode::Ray})
    EXPECT_EQ(stagesOf({.sign = sign}), (Names{"begin", "exact_distance", "crossings", "ray_map", "winding",
                                               "orientation", "sign", "finish"}));
  EXPECT_EQ(stagesOf({.sign = SignMode::Harmonic, .closeHoles = true}),
            (Names{"begin", "exact_distance", "crossings", "ray_map", "winding", "orientation",
                   "winding_dipoles", "close_holes", "sign", "finish"}));
}

TEST(Pipeline, LeavesOutWhatTakesAHostThatReadsBack) {
  EXPECT_EQ(stagesOf<FakeBackend>({.sign = SignMode::Harmonic, .closeHoles = true}),
            (Names{"begin", "exact_distance", "crossings", "ray_map", "winding", "winding_dipoles", "sign",
                   "finish"}));
}

TEST(Pipeline, RunsEveryStageAgainWhereListsOutgrewTheirMemory) {
  FakeHostBackend backend(FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Harmonic});
  backend.runsLeft = 1;
  runPipeline(backend);
  const Names once{"begin",          "voxelGrid", "cellDistance", "distanceTransform",
                   "refine",         "crossings", "rayMap",       "winding",
                   "windingDipoles", "sign",      "finish"};
  Names twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_EQ(backend.calls, twice);
}

}  // namespace
}  // namespace raymap
