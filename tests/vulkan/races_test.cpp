// Accesses to memory that nothing orders: in no kernel of the library, and found where they are planted.

#include <algorithm>
#include <cstdlib>
#include <set>

#include "counters/work_counter.h"
#include "shaders/counted_loops.h"
#include "shaders/counted_loops_spv.h"
#include "shaders/planted_crossings_spv.h"
#include "shaders/planted_dipoles_spv.h"
#include "shaders/planted_order_spv.h"
#include "shaders/planted_stack_spv.h"
#include "shaders/planted_transform_spv.h"
#include "shaders/raymap_vulkan_all.h"
#include "shapes.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanRaces : public VulkanTest {
 protected:
  void SetUp() override {
    // Changed kernels are of no use to other runs.
    setenv("RAYMAP_CACHE", "off", 1);
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    counter_.emplace(Measured::Races);
    device_.emplace(DeviceOptions{.guards = true});
    counter_->start(*device_);
  }

  void TearDown() override {
    if (counter_) counter_->stop();
    device_.reset();
    counter_.reset();
    VulkanTest::TearDown();
  }

  /// Returns descriptions of the races in the commands of `work`.
  template <class Work>
  std::vector<std::string> racesIn(const char* stage, Work&& work) {
    counter_->clear();
    counter_->setStage(stage);
    work();
    for (const CountedCommand& command : counter_->commands()) kernels_.insert(command.name);
    return counter_->races();
  }

  /// Looks for a race of a shader in what `work` runs.
  template <class Work>
  void expectRace(const std::string& shader, const std::string& place, Work&& work) {
    const std::vector<std::string> races = racesIn("planted", work);
    EXPECT_TRUE(std::ranges::any_of(races, [&](const std::string& race) {
      return race.starts_with(place) && race.find(": " + shader + ": ") != std::string::npos;
    })) << shader;
  }

  std::optional<WorkCounter> counter_;
  std::optional<Device> device_;
  std::set<std::string> kernels_;
};

// The checks of the self-test run all stages and modes, on meshes that are closed, open, crossing, crowded or
// turned, and below a large triangle.
TEST_F(VulkanRaces, AreInNoKernel) {
  Subject subject(*device_);
  for (const Check& check : allChecks())
    if (check.name != std::string(kLargeInputs))  // They have more accesses than the log holds.
      for (const std::string& race : racesIn(check.name, [&] { check.run(subject); })) ADD_FAILURE() << race;
  for (const Shader& shader : shaders::kAll)
    EXPECT_TRUE(kernels_.contains(std::string(shader.name))) << shader.name << " did not run";
}

TEST_F(VulkanRaces, AreFoundWhereTheyArePlanted) {
  counter_->replace({"crossings_triangles", shaders::kPlantedCrossings.code});
  counter_->replace({"winding_dipoles", shaders::kPlantedDipoles.code});
  counter_->replace({"surface_tree_order", shaders::kPlantedOrder.code});
  counter_->replace({"exact_distance", shaders::kPlantedStack.code});
  counter_->replace({"distance_transform", shaders::kPlantedTransform.code});
  const OwnCellMesh mesh = onGrid(shapes::soup(600, 6), {.resolution = 14});
  expectRace("crossings_triangles", "buffer 'crossings along y' + ",
             [&] { SignProbe(*device_).countCrossings(mesh); });
  const CellLattice cells{{40, 40, 40}};
  Buffer<float> squared(cells.count());
  for (size_t c = 0; c < squared.size(); ++c) squared[c] = float(c % 91);
  expectRace("distance_transform", "shared marks + ",
             [&] { CellProbe(*device_).transform(cells.dims, squared); });
  WindingDipolesStage dipoles(*device_);
  SurfaceProbe surface(*device_);
  const std::vector<float> doubtful(CellLattice{mesh.dims}.count(), 0.5f);
  expectRace("surface_tree_order", "buffer 'order of triangles' + ", [&] { surface.tree(mesh); });
  expectRace("winding_dipoles", "buffer 'winding' + ", [&] { surface.settle(dipoles, mesh, doubtful); });
  expectRace("exact_distance", "shared stackNodes + ", [&] { surface.closest(mesh); });
}

TEST_F(VulkanRaces, AreFoundBetweenCommandsOfAStep) {
  constexpr uint32_t kGroup = 64;
  const Probe probe(*device_);
  const DeviceBuffer values = probe.upload(std::vector<uint32_t>(kGroup), "values"),
                     sums = probe.upload(std::vector<uint32_t>(kGroup), "sums");
  Kernel<CountedLoopsPush> loops(*device_, shaders::kCountedLoops, kGroup);
  const CountedLoopsPush push{.values = values.address(), .sums = sums.address(), .first = 1, .more = 0};
  const auto races = [&](bool isConcurrent) {
    return racesIn("loops", [&] {
      probe.run([&](Commands& commands) {
        const auto record = [&] {
          commands.fill(values, 0);
          for (int turn = 0; turn < 2; ++turn) commands.dispatch(loops, push, kGroup);
        };
        if (isConcurrent)
          commands.concurrent(record);
        else
          record();
      });
    });
  };
  EXPECT_EQ(races(false), std::vector<std::string>());
  const std::string kernel = "unknown shader: ", invocation = " by invocation 0 of group 0, subgroup 0";
  EXPECT_EQ(races(true),
            (std::vector<std::string>{
                "buffer 'values' + 0, stage 'loops', step 1: fill: write; " + kernel + "read" + invocation,
                "buffer 'sums' + 0, stage 'loops', step 1: " + kernel + "write" + invocation + "; " + kernel +
                    "write" + invocation}));
}

}  // namespace
}  // namespace raymap::vulkan
