// Options that contradict each other, or that a call leaves no place for.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>

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

TEST(CheckOptions, RefusesNumbersThatStandForNothing) {
  const auto error = [](const char* kind, int number) {
    return std::string("there is no ") + kind + " with the value " + std::to_string(number);
  };
  EXPECT_EQ(errorOfField({.distance = DistanceMode(4)}), error("distance mode", 4));
  EXPECT_EQ(errorOfField({.distance = DistanceMode(-1)}), error("distance mode", -1));
  EXPECT_EQ(errorOfField({.distance = DistanceMode::Raster}), "");
  EXPECT_EQ(errorOfField({.sign = SignMode(7)}), error("sign mode", 7));
  EXPECT_EQ(errorOfField({.sampling = Sampling(2)}), error("sampling", 2));
  EXPECT_EQ(errorOfField({.sampling = Sampling::Paper}), "");
  EXPECT_EQ(errorOfField({.orientation = Orientation(3)}), error("orientation", 3));
  EXPECT_EQ(errorOfField({.orientation = Orientation::Repair}), "");
  EXPECT_EQ(errorOfRepair({.orientation = Orientation(3)}), error("orientation", 3));
  EXPECT_EQ(usageError([] { Surface(kBall, {.sign = SignMode(7)}); }), error("sign mode", 7));
  const Field field = generate(kBall, fitGrid(kBall, {.resolution = 12})).field;
  EXPECT_EQ(usageError([&] { distanceAt(field, {}, Outside(2)); }), error("kind of outside", 2));
  EXPECT_TRUE(std::isnan(distanceAt(field, {9, 9, 9}, Outside::NaN)));
}

TEST(CheckOptions, RefusesToMakeNoPass) {
  const std::string error = "the number of passes must be 1 or more";
  for (const SignMode sign : {SignMode::Harmonic, SignMode::Paths})
    for (const int passes : {0, -1}) EXPECT_EQ(errorOfField({.sign = sign, .passes = passes}), error);
  EXPECT_EQ(errorOfField({.sign = SignMode::Paths, .passes = 1}), "");
}

TEST(CheckOptions, RefusesObjectsThatWereMovedFrom) {
  const std::string error = "this object was moved from; assign another to it, or use that other one";
  const Grid grid = fitGrid(kBall, {.resolution = 12});
  Generator first, second = std::move(first);
  EXPECT_EQ(usageError([&] { first.generate(kBall, grid); }), error);
  EXPECT_EQ(usageError([&] { second.generate(kBall, grid); }), "");
  Surface surface(kBall), other = std::move(surface);
  const glm::dvec3 point(0.0);
  QueryResult result;
  EXPECT_EQ(usageError([&] { surface.query(std::span(&point, 1), {}, result); }), error);
  EXPECT_EQ(usageError([&] { surface.mesh(); }), error);
  EXPECT_EQ(usageError([&] { other.query(std::span(&point, 1), {}, result); }), "");
  Scene scene, moved = std::move(scene);
  EXPECT_EQ(usageError([&] { scene.size(); }), error);
  EXPECT_EQ(usageError([&] { scene.add("a", std::make_shared<const Surface>(kBall)); }), error);
  scene = std::move(moved);
  EXPECT_EQ(scene.size(), 0u);
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
  EXPECT_FALSE(made.report.keepsFaces());
}

}  // namespace
}  // namespace raymap
