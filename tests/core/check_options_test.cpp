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

std::string errorOfField(const FieldOptions& options) {
  return usageError([&] { generate(kBall, fitGrid(kBall, {.resolution = 12}), options); });
}

std::string errorOfRepair(const FieldOptions& options, const RepairOptions& repair = {},
                          const MachineOptions& machine = {}) {
  return usageError(
      [&] { raymap::repair(kBall, fitGrid(kBall, {.resolution = 12}), options, repair, machine); });
}

TEST(CheckOptions, RefusesSignsOfAFieldWithoutOne) {
  const std::string error = "winding numbers and confidences need a sign";
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .winding = true}).find(error), 0u);
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .confidence = true}).find(error), 0u);
  EXPECT_EQ(errorOfField({.sign = SignMode::None, .triangle = true}), "");
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

TEST(CheckOptions, RefusesNegativeThreadsInEveryCall) {
  const MachineOptions wrong{.device = "cpu", .threads = -1};
  const Grid grid = fitGrid(kBall, {.resolution = 12});
  const Field field = generate(kBall, grid).field;
  const std::vector<glm::dvec3> points(1);
  const std::vector<std::function<void()>> calls{[&] { generate(kBall, grid, {}, wrong); },
                                                 [&] { Surface(kBall, {}, wrong); },
                                                 [&] { Surface(kBall).query(points, {}, wrong); },
                                                 [&] { Surface(kBall).generate(grid, {}, wrong); },
                                                 [&] { repair(kBall, grid, {}, {}, wrong); },
                                                 [&] { simplify(kBall, {.tolerance = 0.01}, wrong); },
                                                 [&] { isosurface(field, {}, wrong); },
                                                 [&] { sample(field, points, {}, wrong); },
                                                 [&] { diagnose(kBall, {}, wrong); },
                                                 [&] { findSelfIntersections(kBall, wrong); },
                                                 [&] { findThinnest(kBall, 1.0, wrong); }};
  for (size_t k = 0; k < calls.size(); ++k)
    EXPECT_EQ(usageError(calls[k]), "the number of threads must not be negative") << "call " << k;
}

// A mesh that is kept needs no field, but its options are checked all the same.
TEST(CheckOptions, RefusesWhatARepairLeavesNoPlaceFor) {
  for (const bool remesh : {false, true}) {
    const auto refuses = [&](const FieldOptions& options, const std::string& what) {
      const std::string error = errorOfRepair(options, {.remesh = remesh});
      EXPECT_NE(error.find(what), std::string::npos) << error;
    };
    refuses({.sign = SignMode::None}, "the sign mode must not be none");
    refuses({.thickness = 0.5}, "FieldOptions::thickness must be 0");
    refuses({.sign = SignMode::None, .thickness = 0.5}, "must");
    refuses({.invert = true}, "leave out FieldOptions::invert");
    refuses({.band = 1.0}, "leave out FieldOptions::band");
    refuses({.closeHoles = true}, "use RepairOptions::closeHoles");
    refuses({.triangle = true}, "a repair gives no field");
    refuses({.winding = true}, "a repair gives no field");
    refuses({.confidence = true}, "a repair gives no field");
    EXPECT_EQ(errorOfRepair({}, {.remesh = remesh}, {.threads = -1}),
              "the number of threads must not be negative");
    refuses({.threshold = -0.5}, "the threshold must not be negative");
    EXPECT_EQ(errorOfRepair({.sign = SignMode::Rays}, {.remesh = remesh}, {.device = "cpu", .threads = 1}),
              "");
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
  EXPECT_FALSE(made.report.kept);
}

}  // namespace
}  // namespace raymap
