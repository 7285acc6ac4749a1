// Options that contradict each other, or that a call leaves no place for.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "shapes.h"

namespace raymap {
namespace {

template <class Work>
std::string usageError(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Usage) << error.what();
    return error.what();
  }
  return "";
}

const Mesh kBall = shapes::sphere(1.0, 2);

std::string errorOfField(const Options& options) {
  return usageError([&] { generate(kBall, fitGrid(kBall, {.resolution = 12}), options); });
}

std::string errorOfRepair(const Options& options, const RepairOptions& repair = {}) {
  return usageError([&] { raymap::repair(kBall, fitGrid(kBall, {.resolution = 12}), options, repair); });
}

TEST(CheckOptions, RefusesSignsOfAFieldWithoutOne) {
  const std::string error = "winding numbers and confidences need a sign";
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .winding = true}).find(error), 0u);
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .confidence = true}).find(error), 0u);
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .triangleIds = true}), "");
  EXPECT_EQ(errorOfField({.sign = SignMode::Ray, .winding = true, .confidence = true}), "");
  const std::string ofThickness = "a thickness takes the place of the sign";
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .winding = true, .thickness = 0.1}).find(ofThickness), 0u);
  EXPECT_EQ(errorOfField({.confidence = true, .thickness = 0.1}).find(ofThickness), 0u);
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .thickness = 0.1}), "");
  const Surface surface(kBall);
  const Grid grid = fitGrid(kBall, {.resolution = 12});
  EXPECT_EQ(
      usageError([&] { surface.generate(grid, {.sign = SignMode::None, .winding = true}); }).find(error), 0u);
}

// A mesh that is kept needs no field, but its options are checked all the same.
TEST(CheckOptions, RefusesWhatARepairLeavesNoPlaceFor) {
  for (const bool remesh : {false, true}) {
    const auto refuses = [&](const Options& options, const std::string& what) {
      const std::string error = errorOfRepair(options, {.remesh = remesh});
      EXPECT_NE(error.find(what), std::string::npos) << error;
    };
    refuses({.sign = SignMode::None}, "the sign mode must not be none");
    refuses({.thickness = 0.5}, "Options::thickness must be 0");
    refuses({.sign = SignMode::None, .thickness = 0.5}, "must");
    refuses({.invert = true}, "leave out Options::invert");
    refuses({.band = 1.0}, "leave out Options::band");
    refuses({.closeHoles = true}, "use RepairOptions::closeHoles");
    refuses({.triangleIds = true}, "a repair gives no field");
    refuses({.winding = true}, "a repair gives no field");
    refuses({.confidence = true}, "a repair gives no field");
    refuses({.threads = -1}, "the number of threads must not be negative");
    refuses({.threshold = -0.5}, "the threshold must not be negative");
    EXPECT_EQ(errorOfRepair({.sign = SignMode::Rays, .threads = 1, .device = "cpu"}, {.remesh = remesh}), "");
  }
}

TEST(CheckOptions, ARepairClosesHolesByDefault) {
  Mesh open = kBall;
  open.triangles.pop_back();
  const Repaired closed = repair(open, fitRepairGrid(open, {.resolution = 12}));
  EXPECT_EQ(closed.report.closedHoles, 1u);
  EXPECT_EQ(closed.mesh.triangles.size(), kBall.triangles.size());
  const Repaired made = repair(open, fitRepairGrid(open, {.resolution = 12}), {}, {.closeHoles = false});
  EXPECT_EQ(made.report.closedHoles, 0u);
  EXPECT_FALSE(made.report.isKept);
}

}  // namespace
}  // namespace raymap
