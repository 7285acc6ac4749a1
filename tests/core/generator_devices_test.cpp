// A generator keeps its device from one call to the next.

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/repair.h>

#include <algorithm>

#include "counting_gpu.h"
#include "shapes.h"

namespace raymap {
namespace {

class GeneratorDevices : public testing::Test {
 protected:
  Stats generate(const std::string& device, const ProgressCallback& progress = {}) {
    const Mesh mesh = shapes::sphere(1.0, 1);
    const auto warn = [&](const Warning& warning) { warning_ = warning.message; };
    return generator_.generate(mesh, fitGrid(mesh, {.resolution = 8}), {}, field_,
                               {.device = device, .warn = warn, .progress = progress});
  }

  ErrorCode codeOf(const std::string& device, const ProgressCallback& progress = {}) {
    try {
      generate(device, progress);
    } catch (const Error& error) {
      return error.code();
    }
    ADD_FAILURE() << "no error";
    return {};
  }

  CountingGpu gpu_;
  Generator generator_;
  Field field_;
  std::string warning_;
};

TEST_F(GeneratorDevices, AreListedAndOpenedOnce) {
  for (const char* name : {"vulkan:3", "vulkan", "auto"}) {
    SCOPED_TRACE(name);
    CountingGpu::lists = CountingGpu::opens = CountingGpu::runs = 0;
    for (int call = 0; call < 3; ++call) EXPECT_EQ(generate(name).device, "vulkan:3");
    EXPECT_EQ(CountingGpu::lists, 1);
    EXPECT_EQ(CountingGpu::opens, 1);
    EXPECT_EQ(CountingGpu::runs, 3);
  }
}

TEST_F(GeneratorDevices, AreOpenedOnceForARepair) {
  const Mesh sheet = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  const RepairOptions changes{.minThickness = 0.5};
  const Grid grid = fitRepairGrid(sheet, {.voxelSize = 0.2}, changes);
  const Repaired repaired = repair(sheet, grid, {}, changes, {.device = "vulkan:3"});
  EXPECT_EQ(repaired.report.thickenedShare, 1.0);
  EXPECT_EQ(CountingGpu::runs, 3)
      << "for the solid, the plates, and what is missed, as this GPU shows no plates";
  EXPECT_EQ(CountingGpu::lists, 1);
  EXPECT_EQ(CountingGpu::opens, 1);
  const std::vector<Stats::Stage>& stages = repaired.report.stats.stages;
  for (const char* name :
       {"inspect", "surface", "thicken", "isosurface", "pieces", "points", "simplify", "measure"})
    EXPECT_EQ(std::ranges::count(stages, name, &Stats::Stage::name), 1) << name;
}

TEST_F(GeneratorDevices, StayOpenWhenACallIsCancelled) {
  EXPECT_EQ(codeOf("vulkan:3", [](std::string_view, double) { return false; }), ErrorCode::Cancelled);
  EXPECT_TRUE(field_.distance.empty());
  generate("vulkan:3");
  EXPECT_EQ(CountingGpu::lists, 1);
  EXPECT_EQ(CountingGpu::opens, 1);
}

TEST_F(GeneratorDevices, StayOpenWhenTheInputOrTheOptionsAreWrong) {
  for (const ErrorCode code : {ErrorCode::Input, ErrorCode::Usage}) {
    CountingGpu::onGenerate = [code] { throw Error(code, "wrong"); };
    EXPECT_EQ(codeOf("vulkan:3"), code);
  }
  CountingGpu::onGenerate = {};
  generate("vulkan:3");
  EXPECT_EQ(CountingGpu::lists, 1);
  EXPECT_EQ(CountingGpu::opens, 1);
}

TEST_F(GeneratorDevices, AreOpenedAnewAfterTheyAreLost) {
  CountingGpu::onGenerate = [] { throw Error(ErrorCode::DeviceLost, "lost"); };
  EXPECT_EQ(codeOf("vulkan:3"), ErrorCode::DeviceLost);
  CountingGpu::onGenerate = {};
  EXPECT_EQ(generate("vulkan:3").device, "vulkan:3");
  EXPECT_EQ(CountingGpu::opens, 2);
}

TEST_F(GeneratorDevices, FallBackToTheCpuWithAWarning) {
  CountingGpu::onGenerate = [] { throw Error(ErrorCode::DeviceLost, "it went away"); };
  EXPECT_EQ(generate("auto").device, "cpu");
  EXPECT_NE(warning_.find("it went away"), std::string::npos) << warning_;
  EXPECT_FALSE(field_.distance.empty());
  CountingGpu::onGenerate = {};
  warning_.clear();
  EXPECT_EQ(generate("auto").device, "vulkan:3");
  EXPECT_EQ(warning_, "");
  EXPECT_EQ(CountingGpu::opens, 2);
}

TEST_F(GeneratorDevices, ChangeWithTheName) {
  EXPECT_EQ(generate("vulkan:3").device, "vulkan:3");
  EXPECT_EQ(generate("cpu").device, "cpu");
  EXPECT_EQ(generate("vulkan:3").device, "vulkan:3");
  EXPECT_EQ(CountingGpu::opens, 2);
}

TEST_F(GeneratorDevices, AreToldApartByName) {
  for (const char* name : {"gpu", "vulkan:", "vulkan:x", "vulkan:-1", "vulkan:1x", ""})
    EXPECT_EQ(codeOf(name), ErrorCode::Usage) << name;
  EXPECT_EQ(codeOf("vulkan:99"), ErrorCode::Unsupported);
}

}  // namespace
}  // namespace raymap
