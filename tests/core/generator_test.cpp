#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>

#include "any_threads.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "reference.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {
namespace {

TEST(Generator, GivesTheSignedDistanceOfASphere) {
  const Mesh mesh = shapes::sphere(1.0, 4, {5, -3, 2});
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  const Field field = generate(mesh, grid).field;
  for (size_t k = 0; k < field.distance.size(); ++k) {
    const glm::ivec3 s(k % grid.dims.x, k / grid.dims.x % grid.dims.y, k / grid.dims.x / grid.dims.y);
    const double exact = glm::distance(grid.position(glm::dvec3(s)), glm::dvec3(5, -3, 2)) - 1.0;
    ASSERT_NEAR(field.distance[k], exact, 0.006) << k;
  }
}

// One triangle becomes a plate with round edges.
TEST(Generator, MakesSolidsOfSheets) {
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  const Grid grid = fitGrid(mesh, {.voxelSize = 0.1, .padding = 0.3});
  for (const double band : {0.0, 3.0, 1.0})
    for (const bool invert : {false, true}) {
      FieldOptions options;
      options.thickness = 0.4;
      options.band = band;
      options.invert = invert;
      const Field field = generate(mesh, grid, options).field;
      const double most = band > 0.0 ? band * grid.spacing : INFINITY;
      EXPECT_DOUBLE_EQ(field.clampDistance, band * grid.spacing);
      for (size_t k = 0; k < field.distance.size(); ++k) {
        const glm::ivec3 s(k % grid.dims.x, k / grid.dims.x % grid.dims.y, k / grid.dims.x / grid.dims.y);
        const double exact = std::clamp(reference::distance(mesh, grid.position(s)) - 0.2, -most, most);
        ASSERT_NEAR(field.distance[k], invert ? -exact : exact, 1e-6) << k;
      }
    }
  FieldOptions options;
  options.thickness = 0.4;
  options.winding = true;
  EXPECT_THROW(generate(mesh, grid, options), Error);
}

/// Returns the warnings of a field.
std::vector<Warning> warningsOf(const Mesh& mesh, const Grid& grid, const FieldOptions& options = {}) {
  std::vector<Warning> warnings;
  const auto warn = [&](const Warning& warning) { warnings.push_back(warning); };
  generate(mesh, grid, options, {.device = "cpu", .warn = warn});
  return warnings;
}

TEST(Generator, WarnsIfNothingIsInside) {
  // A plate between two layers of samples.
  const Mesh plate = shapes::box({-1, -1, 0.04}, {1, 1, 0.06});
  const Grid grid{.dims = {24, 24, 5}, .origin = {-1.15, -1.15, -0.2}, .spacing = 0.1};
  for (const bool invert : {false, true}) {
    const std::vector<Warning> warnings = warningsOf(plate, grid, {.invert = invert});
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, WarningCode::NothingInside);
    EXPECT_EQ(
        warnings[0].message,
        "no sample is inside, because the mesh is thinner than the spacing 0.1; use a spacing of 0.0098");
    EXPECT_DOUBLE_EQ(warnings[0].fields.voxelSize, 0.0098);  // 0.08 / 8.16, rounded down.
    EXPECT_EQ(warnings[0].fields.length, 0.0);
  }
  // What it advises helps.
  EXPECT_TRUE(warningsOf(plate, fitGrid(plate, {.voxelSize = 0.0098})).empty());
}

TEST(Generator, AdvisesAThicknessWhereNothingIsEnclosed) {
  Mesh sheet = shapes::box({-1, -1, 0.04}, {1, 1, 0.06});
  std::erase_if(sheet.triangles, [&](const glm::uvec3& t) {
    return sheet.position(t.x).z < 0.05 || sheet.position(t.y).z < 0.05 || sheet.position(t.z).z < 0.05;
  });
  ASSERT_EQ(sheet.triangles.size(), 2u);
  const Grid grid = fitGrid(sheet, {.voxelSize = 0.1});
  const std::vector<Warning> warnings = warningsOf(sheet, grid);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::NothingInside);
  EXPECT_EQ(warnings[0].fields.voxelSize, 0.0);
  EXPECT_DOUBLE_EQ(warnings[0].fields.length, 0.2);
  EXPECT_NE(warnings[0].message.find("with a thickness of 0.2"), std::string::npos) << warnings[0].message;
  EXPECT_TRUE(warningsOf(sheet, grid, {.thickness = 0.2}).empty());
  EXPECT_TRUE(warningsOf(sheet, grid, {.sign = SignMode::None}).empty());
  // Both sides of it: closed, but without a volume.
  Mesh both = sheet;
  for (const glm::uvec3& t : sheet.triangles) both.triangles.push_back({t.x, t.z, t.y});
  const std::vector<Warning> ofBoth = warningsOf(both, grid);
  ASSERT_EQ(ofBoth.size(), 1u);
  EXPECT_DOUBLE_EQ(ofBoth[0].fields.length, 0.2);
  // A plate so thin that no grid would have place for its samples.
  const Mesh foil = shapes::box({-1, -1, 0.05}, {1, 1, 0.051});
  const std::vector<Warning> ofFoil =
      warningsOf(foil, {.dims = {24, 24, 5}, .origin = {-1.15, -1.15, -0.2}, .spacing = 0.1});
  ASSERT_EQ(ofFoil.size(), 1u);
  EXPECT_DOUBLE_EQ(ofFoil[0].fields.length, 0.2);
}

TEST(Generator, DoesNotWarnOfAMeshThatReachesBeyondTheGrid) {
  const Mesh ball = shapes::sphere(1.0, 3);
  // Beside the ball, a corner in its bounds.
  const Grid grid{.dims = {8, 8, 8}, .origin = glm::dvec3(0.9), .spacing = 0.1};
  EXPECT_TRUE(warningsOf(ball, grid).empty());
  // One sample in the middle is inside.
  EXPECT_TRUE(warningsOf(ball, {.dims = {1, 1, 1}, .origin = glm::dvec3(0.0), .spacing = 2.0}).empty());
  // The grid's cells end where the mesh does, its samples before: between four edges of the box.
  const Mesh frame =
      shapes::joined(shapes::box({-1, -1, -1}, {-0.99, 1, 1}), shapes::box({0.99, -1, -1}, {1, 1, 1}));
  const Grid tight = fitGrid(frame, {.resolution = 4, .padding = 0.0});
  EXPECT_EQ(warningsOf(frame, tight).size(), 1u);
  Grid shorter = tight;
  shorter.dims.x = 3;
  EXPECT_TRUE(warningsOf(frame, shorter).empty());
  shorter.origin.x += tight.spacing;
  EXPECT_TRUE(warningsOf(frame, shorter).empty());
}

TEST(Generator, MakesTheFarFieldOfAnEmptyMesh) {
  const Mesh empty;
  const Grid grid{.dims = {3, 4, 5}, .origin = glm::dvec3(-1.0), .spacing = 0.5};
  FieldOptions options{.triangle = true, .winding = true, .confidence = true};
  try {
    generate(empty, grid, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_STREQ(error.what(),
                 "the mesh has no triangles; allow empty meshes for a field that is far everywhere");
  }
  options.allowEmpty = true;
  const auto expectAll = [](const auto& array, auto value) {
    EXPECT_EQ(array.size(), 60u);
    EXPECT_TRUE(std::ranges::all_of(array, [&](auto each) { return each == value; }));
  };
  for (const double band : {0.0, 3.0})
    for (const bool invert : {false, true}) {
      options.band = band;
      options.invert = invert;
      std::vector<Warning> warnings;
      const auto [field, stats] = generate(
          empty, grid, options, {.warn = [&](const Warning& warning) { warnings.push_back(warning); }});
      expectAll(field.distance, (invert ? -1.0f : 1.0f) * (band > 0.0 ? 1.5f : FLT_MAX));
      expectAll(field.triangle, kNoTriangle);
      expectAll(field.winding, 0.0f);
      expectAll(field.confidence, 1.0f);
      EXPECT_EQ(field.grid, grid);
      EXPECT_EQ(field.clampDistance, band * 0.5);
      EXPECT_TRUE(field.surfaceBounds.isEmpty());
      EXPECT_TRUE(warnings.empty());
      EXPECT_EQ(stats.device, "");
    }
  // Without sides there is nothing to invert.
  expectAll(
      generate(empty, grid, {.sign = SignMode::None, .invert = true, .allowEmpty = true}).field.distance,
      FLT_MAX);
  const Field plate =
      generate(empty, grid, {.sign = SignMode::None, .invert = true, .thickness = 0.1, .allowEmpty = true})
          .field;
  expectAll(plate.distance, -FLT_MAX);
  EXPECT_TRUE(plate.triangle.empty() && plate.winding.empty() && plate.confidence.empty());
  EXPECT_THROW(generate(empty, {}, {.allowEmpty = true}), Error);
  EXPECT_THROW(generate(empty, grid, {.allowEmpty = true}, {.memoryLimit = 239}), Error);
  EXPECT_NO_THROW(generate(empty, grid, {.allowEmpty = true}, {.memoryLimit = 240}));
}

TEST(Generator, ForgetsTheLastMeshForAnEmptyOne) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const Grid grid = fitGrid(ball, {.resolution = 8});
  Generator generator;
  Field field;
  const FieldOptions options{.band = 2.0, .allowEmpty = true};
  generator.generate(ball, grid, {.band = 2.0, .triangle = true}, field);
  generator.generate(Mesh{}, grid, options, field);
  EXPECT_TRUE(field.triangle.empty());
  EXPECT_TRUE(field.surfaceBounds.isEmpty());
  // Far samples of both frames are the same.
  EXPECT_EQ(field.distance[0], float(2.0) * float(grid.spacing));
  generator.generate(ball, grid, options, field);
  EXPECT_EQ(field.distance[0], float(2.0) * float(grid.spacing));
  EXPECT_LT(*std::ranges::min_element(field.distance), 0.0f);
}

TEST(Generator, ReusesItsBuffersAndGivesTheSame) {
  const Mesh mesh = shapes::soup(200, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 32});
  Generator generator;
  Field first, again;
  FieldOptions options;
  options.winding = options.confidence = options.triangle = true;
  const size_t held = generator.generate(mesh, grid, options, first).bytes;
  generator.generate(shapes::sphere(1.0, 3), grid, {}, again);
  const size_t heldAgain = generator.generate(mesh, grid, options, again).bytes;
  EXPECT_TRUE(sameBits(first.distance, again.distance));
  EXPECT_TRUE(sameBits(first.winding, again.winding));
  EXPECT_LE(heldAgain, held + (held / 2));
}

TEST(Generator, StopsWhenAskedAndLeavesNothing) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 64});
  for (const int stopAt : {0, 1, 3, 6}) {
    int calls = 0;
    const auto stop = [&](std::string_view, double) { return calls++ < stopAt; };
    Field field;
    EXPECT_EQ(codeOf([&] { Generator().generate(mesh, grid, {}, field, {.progress = stop}); }),
              ErrorCode::Cancelled);
    EXPECT_TRUE(field.distance.empty());
  }
}

/// Cancels at the `stopAt`-th call from `stage`, on one thread: of several, all but one may be skipped.
/// Returns the share of the stage that was done then.
double shareWhenStopped(const Mesh& mesh, const Grid& grid, const FieldOptions& options,
                        std::string_view stage, int stopAt) {
  double share = INFINITY;
  int calls = 0;
  const auto stop = [&](std::string_view name, double done) {
    if (name != stage || ++calls < stopAt) return true;
    EXPECT_EQ(calls, stopAt) << "it went on";
    share = done;
    return false;
  };
  Field field;
  EXPECT_EQ(
      codeOf([&] { Generator().generate(mesh, grid, options, field, {.threads = 1, .progress = stop}); }),
      ErrorCode::Cancelled);
  return share;
}

/// Expects the exact number at all samples that lie on no face.
void expectExact(const Mesh& mesh, const Grid& grid, Orientation orientation, const Mesh& turned) {
  const Field field =
      generate(mesh, grid, {.sign = SignMode::Exact, .orientation = orientation, .winding = true}).field;
  for (uint32_t s = 0; s < grid.sampleCount(); ++s) {
    const glm::dvec3 p = samplePosition(grid, s);
    if (reference::distance(turned, p) < 1e-6) continue;
    const double exact = reference::windingNumber(turned, p);
    ASSERT_NEAR(field.winding[s], exact, 4e-6) << s;
    if (std::abs(std::abs(exact) - 0.5) > 4e-6) {
      ASSERT_EQ(field.distance[s]<0.0f, std::abs(exact)> 0.5) << s;
    }
  }
}

TEST(Generator, HasExactNumbersOnRequest) {
  const Mesh soup = shapes::soup(1500, 7), open = withHoles(shapes::sphere(1.0, 3), 4, 0.2, 5);
  expectExact(soup, fitGrid(soup, {.resolution = 10}), Orientation::Keep, soup);
  for (const Orientation orientation : {Orientation::Keep, Orientation::Auto}) {
    expectExact(open, fitGrid(open, {.resolution = 14}), orientation, open);
    const Box part{{-0.5, -0.4, 0.2}, {0.9, 0.8, 1.1}};  // The mesh reaches beyond it.
    expectExact(open, fitGrid(open, {.resolution = 10, .box = part}), orientation, open);
  }
  Mesh turned = open;
  for (size_t f = 0; f < turned.triangles.size(); f += 5)
    std::swap(turned.triangles[f].x, turned.triangles[f].y);
  expectExact(turned, fitGrid(open, {.resolution = 14}), Orientation::Auto, open);
}

TEST(Generator, StopsWithinALongStage) {
  const Mesh mesh = shapes::soup(300, 5);
  const Grid grid = fitGrid(mesh, {.resolution = 48});
  FieldOptions options;
  options.passes = 100'000'000;
  for (const SignMode sign : {SignMode::Paths, SignMode::Evolution}) {
    options.sign = sign;
    EXPECT_LT(shareWhenStopped(mesh, grid, options, "winding", 200), 1e-5);
  }
  EXPECT_LE(shareWhenStopped(mesh, grid, {}, "winding", 50), 1.0);  // harmonic
  EXPECT_LE(shareWhenStopped(mesh, grid, {}, "crossings", 5), 1.0);
  options.distance = DistanceMode::Neighbours;
  for (const char* stage : {"voxel_grid", "cell_distance", "distance_transform", "refine"})
    EXPECT_LE(shareWhenStopped(mesh, grid, options, stage, 3), 1.0);
}

TEST(Generator, NamesTheMemoryItNeeds) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  EXPECT_NE(
      messageOf(ErrorCode::Memory,
                [&] { generate(mesh, fitGrid(mesh, {.resolution = 256}), {}, {.memoryLimit = 1 << 20}); })
          .find("only 1 MiB"),
      std::string::npos);
}

TEST(Generator, RefusesInvalidMeshes) {
  Mesh mesh = shapes::sphere(1.0, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  mesh.vertices[7].y = NAN;
  EXPECT_THROW(generate(mesh, grid), Error);
  mesh.triangles.clear();
  EXPECT_THROW(generate(mesh, grid), Error);
}

TEST(Generator, RefusesTrianglesOfTheRasterDistance) {
  const Mesh mesh = shapes::sphere(1.0, 1);
  FieldOptions options;
  options.distance = DistanceMode::Raster;
  options.triangle = true;
  EXPECT_THROW(generate(mesh, fitGrid(mesh, {.resolution = 16}), options), Error);
}

TEST(Generator, ClampsToTheBand) {
  const Mesh mesh = shapes::torus(1.0, 0.4, 60, 30);
  const Grid grid = fitGrid(mesh, {.resolution = 50});
  const Field full = generate(mesh, grid).field;
  FieldOptions options;
  options.band = 3.0;
  const Field band = generate(mesh, grid, options).field;
  const auto limit = static_cast<float>(3.0 * grid.spacing);
  for (size_t k = 0; k < full.distance.size(); ++k)
    ASSERT_NEAR(band.distance[k], std::clamp(full.distance[k], -limit, limit), 1e-5 * grid.spacing);
}

TEST(Generator, InvertsOnRequest) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  FieldOptions options;
  options.invert = true;
  const Field plain = generate(mesh, grid).field, inverted = generate(mesh, grid, options).field;
  for (size_t k = 0; k < plain.distance.size(); ++k) ASSERT_EQ(plain.distance[k], -inverted.distance[k]);
}

}  // namespace
}  // namespace raymap
