#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>

#include "error_code.h"
#include "field/field_sampler.h"
#include "shapes.h"

namespace raymap {
namespace {

TEST(Grid, CoversThePaddedBounds) {
  const Grid grid = fitGrid(shapes::box({0, 0, 0}, {2, 1, 1}), {.resolution = 24});
  EXPECT_NEAR(grid.spacing, 2.4 / 24, 1e-12);
  EXPECT_EQ(grid.dims, glm::ivec3(24, 14, 14));
  EXPECT_NEAR(grid.origin.x, -0.2 + 0.05, 1e-12);
}

TEST(Grid, MustLieWhereNumbersReach) {
  const auto problem = [](glm::ivec3 dims, const glm::dvec3& origin, double spacing) {
    return placeProblem({dims, origin, spacing});
  };
  const glm::ivec3 dims(3, 2, 2);
  EXPECT_EQ(problem(dims, {0, 0, 0}, 1.0), "");
  EXPECT_EQ(problem(dims, {0, 0, 0}, DBL_MIN), "");
  EXPECT_EQ(problem(dims, {0, -FLT_MAX, FLT_MAX}, DBL_MIN), "");
  EXPECT_EQ(problem(dims, {0, 0, 0}, 0.5 * FLT_MAX), "");
  EXPECT_EQ(problem(dims, {0, 0, 0}, 0.0), "the grid's spacing is 0; it must be positive and finite");
  EXPECT_EQ(problem(dims, {0, 0, 0}, NAN), "the grid's spacing is nan; it must be positive and finite");
  EXPECT_EQ(problem(dims, {0, 0, 0}, INFINITY), "the grid's spacing is inf; it must be positive and finite");
  EXPECT_EQ(problem(dims, {0, 0, 0}, 1e-310), "the grid's spacing is 1e-310, too small for double precision");
  EXPECT_EQ(problem(dims, {0, NAN, 0}, 1.0), "the grid's origin has y = nan; it must be finite");
  const std::string beyond = ", and distances are known up to 3.4e38";
  EXPECT_EQ(problem(dims, {0, 0, -1e39}, 1.0), "the grid reaches to z = -1e+39" + beyond);
  EXPECT_EQ(problem(dims, {0, 0, 0}, 2e38), "the grid reaches to x = 4e+38" + beyond);
  EXPECT_EQ(problem(dims, {1e308, 0, 0}, 1e308), "the grid reaches to x = 1e+308" + beyond);
  Field field{.grid = {glm::ivec3(1), {0, 0, 0}, 1e-310}};
  field.distance.resizeUninitialized(1);
  Samples samples;
  EXPECT_EQ(codeOf([&] { sample(field, {}, {}, samples); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] {
              generate(shapes::box({0, 0, 0}, {1, 1, 1}), {dims, {0, 0, 0}, 1e300});
            }),
            ErrorCode::Usage);
}

TEST(Grid, LeavesOutFacesWithoutArea) {
  Mesh mesh = shapes::box({1000, 1000, 0}, {1010, 1010, 10});
  const Grid expected = fitGrid(mesh, {.resolution = 24});
  const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = uint32_t(mesh.vertices.size());
    for (const glm::vec3& p : {a, b, c}) mesh.vertices.push_back(p - glm::vec3(mesh.origin));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  };
  add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  add({0, 0, 0}, {1, 2, 3}, {2, 4, 6});
  EXPECT_EQ(fitGrid(mesh, {.resolution = 24}), expected);
  EXPECT_EQ(gridBounds(mesh).min, glm::dvec3(1000, 1000, 0));
  EXPECT_EQ(bounds(mesh).min, glm::dvec3(0.0));
  const std::vector<glm::dvec3> doubles{{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {-9, 0, 0}};
  const std::vector<glm::u64vec3> faces{{0, 1, 2}, {3, 3, 0}, {0, 1, 77}};
  EXPECT_EQ(gridBounds(MeshView(doubles, faces)), (Box{{0, 0, 0}, {1, 1, 1}}));
  add({0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_EQ(gridBounds(mesh).min, glm::dvec3(0.0)) << "a face with an area counts";
}

TEST(Grid, OfFacesWithoutAreaAloneCoversThem) {
  const std::vector<glm::vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<glm::uvec3> face{{0, 1, 2}};
  EXPECT_EQ(gridBounds(MeshView(line, face)), (Box{{0, 0, 0}, {2, 0, 0}}));
}

TEST(Grid, AlignedBeginsAtAMultipleOfEightSpacings) {
  const auto grid = [](double low, double high, double spacing) {
    return fitGrid(Box{glm::dvec3(low), glm::dvec3(high)},
                   {.voxelSize = spacing, .padding = 0.0, .align = true});
  };
  // Cells reach half a spacing beyond their samples: those of samples -1 to 9 cover -1.2 to 9.5.
  EXPECT_EQ(grid(-1.2, 9.5, 1.0), (Grid{glm::ivec3(18), glm::dvec3(-8.0), 1.0}));
  EXPECT_EQ(grid(-1.2, 9.6, 1.0).dims.x, 19);
  EXPECT_EQ(grid(-8.5, 9.0, 1.0).origin.x, -8.0);
  EXPECT_EQ(grid(-8.6, 9.0, 1.0).origin.x, -16.0);
  EXPECT_EQ(grid(-0.5, 0.5, 1.0), (Grid{glm::ivec3(1), glm::dvec3(0.0), 1.0}));
  EXPECT_EQ(grid(0.0, 1.0, 0.02), (Grid{glm::ivec3(51), glm::dvec3(0.0), 0.02}));
  EXPECT_EQ(grid(7.6, 7.7, 1.0), (Grid{glm::ivec3(1), glm::dvec3(8.0), 1.0}));
  EXPECT_EQ(grid(16.7, 20.0, 0.1).origin.x, 160 * 0.1);
  EXPECT_EQ(grid(0.0, 3.0, 0.5).spacing, 0.5);
  const Grid byResolution = fitGrid(shapes::box({0, 0, 0}, {2, 1, 1}), {.resolution = 24, .align = true});
  EXPECT_NEAR(byResolution.spacing, 0.1, 1e-12);
  EXPECT_EQ(byResolution.origin, glm::dvec3(-8 * byResolution.spacing));
}

TEST(Grid, AlignedIsRefusedWhereItCannotBe) {
  const auto message = [](const GridOptions& options) -> std::string {
    try {
      fitGrid(Box{glm::dvec3(1e9), glm::dvec3(1e9 + 1)}, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({.dims = glm::ivec3(4), .align = true}),
            "samples about the centre of the box cannot be aligned; leave out their number");
  EXPECT_EQ(
      message({.voxelSize = 0.1, .align = true}),
      "the box lies so many spacings of 0.1 from 0 that samples cannot be aligned; use a larger voxel size, "
      "or move the mesh");
  EXPECT_EQ(message({.voxelSize = 2.0, .align = true}), "");
}

TEST(Grid, OfAnEmptyMeshNeedsABox) {
  const Box box{glm::dvec3(0.0), glm::dvec3(1.0)};
  EXPECT_EQ(fitGrid(Mesh{}, {.resolution = 4, .box = box}).dims, glm::ivec3(4));
  try {
    fitGrid(Mesh{});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_STREQ(error.what(), "the mesh has no triangles, so it has no bounds; give a box to cover");
  }
}

TEST(Grid, OfARepairHoldsThePaddingAndAPositiveOffset) {
  const Mesh mesh = shapes::box({0, 0, 0}, {2, 1, 1});
  GridOptions options{.voxelSize = 0.1, .padding = 0.2};
  options.box = Box{glm::dvec3(0), glm::dvec3(9)};
  const Grid grown = fitRepairGrid(mesh, options, {.offset = 0.3});
  EXPECT_EQ(grown.dims, glm::ivec3(34, 24, 24));
  EXPECT_NEAR(grown.origin.y, -0.7 + 0.05, 1e-12);
  EXPECT_EQ(fitRepairGrid(mesh, options, {.offset = -0.3}).dims, glm::ivec3(28, 18, 18));
}

TEST(Grid, OfARepairHasMoreSamples) {
  const Mesh mesh = shapes::box({0, 0, 0}, {2, 1, 1});
  EXPECT_EQ(fitGrid(mesh).dims.x, 128);
  EXPECT_EQ(fitRepairGrid(mesh).dims.x, 256);
  EXPECT_EQ(fitRepairGrid(mesh, {.resolution = 30}).dims.x, 30);
}

TEST(Grid, OfARepairIsAsDenseAsTheThinnestPartNeeds) {
  const auto plate = [](double thickness) { return shapes::box({0, 0, 0}, {2, 1, thickness}); };
  const RepairGrid usual = fitRepairGrid(plate(0.1));
  EXPECT_EQ(usual.dims.x, 256);
  EXPECT_FALSE(usual.thinnest);
  const RepairGrid dense = fitRepairGrid(plate(0.012));
  ASSERT_TRUE(dense.thinnest);
  EXPECT_NEAR(*dense.thinnest, 0.012, 1e-6);
  EXPECT_LE(dense.spacing, 0.006);
  EXPECT_GE(dense.spacing, 0.0057);
  EXPECT_TRUE(dense.keepsThinnest());
  // It is within the memory, and within the most samples.
  const RepairGrid limited = fitRepairGrid(plate(0.012), {}, {}, {.memoryLimit = 100'000'000});
  EXPECT_EQ(limited.dims.x, 256);
  EXPECT_FALSE(limited.keepsThinnest());
  const RepairGrid thin = fitRepairGrid(plate(0.0005));
  EXPECT_EQ(thin.dims.x, 256);
  EXPECT_NEAR(*thin.thinnest, 0.0005, 1e-6);
  EXPECT_FALSE(thin.keepsThinnest());
  // What was asked for rules.
  EXPECT_EQ(fitRepairGrid(plate(0.012), {.resolution = 40}).dims.x, 40);
  EXPECT_FALSE(fitRepairGrid(plate(0.012), {.voxelSize = 0.01}).thinnest);
}

TEST(Grid, OfASoupNeedsFewerSamples) {
  const Grid grid = fitRepairGrid(shapes::soup(100, 1));
  EXPECT_EQ(std::max({grid.dims.x, grid.dims.y, grid.dims.z}), 128);
}

TEST(Grid, HoldsTheWallAroundASheet) {
  const Mesh mesh = shapes::box({0, 0, 0}, {2, 1, 1});
  const Grid grid = fitGrid(mesh, {.voxelSize = 0.1, .padding = 0.2, .thickness = 0.6});
  EXPECT_EQ(grid.dims, glm::ivec3(34, 24, 24));
  EXPECT_NEAR(grid.origin.y, -0.7 + 0.05, 1e-12);
  const Box box{glm::dvec3(0), glm::dvec3(1)};
  EXPECT_EQ(fitGrid(mesh, {.resolution = 4, .box = box, .thickness = 0.6}),
            fitGrid(mesh, {.resolution = 4, .box = box}));
  for (const double thickness : {-0.1, double(NAN), double(INFINITY)})
    EXPECT_THROW(fitGrid(mesh, {.thickness = thickness}), Error) << thickness;
}

// All lengths are sums of powers of two, so the results are exact.
TEST(Grid, OfAShapeHasTheSmallestCellsThatHoldTheBox) {
  const Mesh mesh = shapes::box({8, -21, 29.5}, {12, -19, 30.5});
  const auto expect = [&](const GridOptions& options, double spacing, glm::dvec3 origin) {
    const Grid grid = fitGrid(mesh, options);
    EXPECT_EQ(grid.dims, *options.dims);
    EXPECT_EQ(grid.spacing, spacing);
    EXPECT_EQ(grid.origin, origin);
    EXPECT_EQ(fitGrid(bounds(mesh), options), grid);
  };
  const glm::dvec3 centre(10, -20, 30);
  const auto first = [&](glm::ivec3 dims, double spacing) {
    return centre - 0.5 * spacing * glm::dvec3(dims - 1);
  };
  // The padded sides are 6, 4 and 3 long. y needs the largest cells.
  const glm::ivec3 flat(32, 8, 8);
  expect({.dims = flat, .padding = 0.25}, 0.5, first(flat, 0.5));
  expect({.resolution = -1, .dims = flat, .padding = 0.0, .thickness = 2.0}, 0.5, first(flat, 0.5));
  // A size of cells rules, also where they then cut the box.
  const glm::ivec3 cube(4);
  expect({.voxelSize = 0.125, .dims = cube}, 0.125, first(cube, 0.125));
  const Box box{{0, 0, 0}, {1, 2, 4}};
  expect({.dims = cube, .box = box, .thickness = 9.0}, 1.0, glm::dvec3(0.5, 1, 2) - 1.5);
  expect({.voxelSize = 2.0, .dims = glm::ivec3(1, 2, 1), .box = box}, 2.0, {0.5, 0, 2});
  // A repair needs all of the mesh in the grid.
  EXPECT_EQ(fitRepairGrid(mesh, {.resolution = 20, .dims = cube}), fitRepairGrid(mesh, {.resolution = 20}));
}

/// Returns the message of the error that `work` throws, which must be one of usage.
template <class Work>
std::string usageError(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Usage);
    return error.what();
  }
  return "";
}

TEST(Grid, RefusesAnEmptyBox) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Box point{glm::dvec3(1), glm::dvec3(1)}, inverted{glm::dvec3(1), glm::dvec3(0)};
  for (const std::optional<glm::ivec3> dims : {std::optional<glm::ivec3>(), {glm::ivec3(4)}}) {
    for (const Box& box : {point, inverted})
      EXPECT_EQ(usageError([&] { fitGrid(mesh, {.dims = dims, .box = box}); }),
                "the box is empty: its maximum must exceed its minimum");
    EXPECT_THROW(fitGrid(mesh, {.voxelSize = 1.0, .dims = dims, .box = inverted}), Error);
    EXPECT_EQ(fitGrid(mesh, {.voxelSize = 1.0, .dims = dims, .box = point}).dims,
              dims.value_or(glm::ivec3(1)));
  }
}

TEST(Grid, RefusesAShapeWithoutSamples) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(usageError([&] { fitGrid(mesh, {.dims = glm::ivec3(8, 0, 8)}); }),
            "the grid must have at least 1 sample along every side, not 8 x 0 x 8");
}

TEST(Grid, NamesTheSideOfABoxThatIsNotFinite) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  for (const double bad : {NAN, INFINITY}) {
    const std::string number = std::to_string(bad);
    for (int axis = 0; axis < 3; ++axis) {
      Box box{glm::dvec3(0), glm::dvec3(1)};
      box.max[axis] = bad;
      const std::string error = usageError([&] { fitGrid(mesh, {.box = box}); });
      EXPECT_EQ(error.find(std::string("the box reaches from ") + "xyz"[axis] + " = 0 to " + number), 0u)
          << error;
    }
  }
  EXPECT_NE(usageError([&] { fitGrid(mesh, {.box = Box{glm::dvec3(-1.5e308), glm::dvec3(1.5e308)}}); }), "");
  EXPECT_EQ(fitGrid(mesh, {.resolution = 1, .box = Box{glm::dvec3(-1e300), glm::dvec3(1e300)}}).dims,
            glm::ivec3(1));
}

// All that take a grid from the caller refuse the same ones, and name the value.
TEST(Grid, NamesTheValueThatIsNotFinite) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Grid grid = fitGrid(mesh, {.resolution = 8});
  Field field = generate(mesh, grid).field;
  const auto refuses = [&](const Grid& bad, const std::string& what) {
    field.grid = bad;
    EXPECT_EQ(usageError([&] { generate(mesh, bad); }).find(what), 0u);
    EXPECT_EQ(usageError([&] { repair(mesh, bad, {}, {}); }).find(what), 0u);
    EXPECT_EQ(usageError([&] { distanceAt(field, {}); }).find(what), 0u);
    EXPECT_EQ(usageError([&] { gradientAt(field, {}); }).find(what), 0u);
    EXPECT_EQ(usageError([&] { sample(field, {}); }).find(what), 0u);
    EXPECT_EQ(usageError([&] { isosurface(field); }).find(what), 0u);
  };
  for (const auto& [bad, number] : {std::pair(double(NAN), "nan"), {INFINITY, "inf"}, {-INFINITY, "-inf"}}) {
    for (int axis = 0; axis < 3; ++axis) {
      Grid moved = grid;
      moved.origin[axis] = bad;
      refuses(moved, std::string("the grid's origin has ") + "xyz"[axis] + " = " + number + ";");
    }
    refuses({grid.dims, grid.origin, bad}, std::string("the grid's spacing is ") + number + ";");
  }
  refuses({grid.dims, grid.origin, 0.0}, "the grid's spacing is 0;");
  refuses({grid.dims, grid.origin, -2.0}, "the grid's spacing is -2;");
  refuses({{8, 0, 8}, grid.origin, 1.0}, "the grid has 8 x 0 x 8 samples;");
  refuses({{-1, 8, 8}, grid.origin, 1.0}, "the grid has -1 x 8 x 8 samples;");
}

TEST(Mesh, NamesTheBadIndex) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles[3].y = 77;
  EXPECT_NE(messageOf(ErrorCode::Input, [&] { validate(mesh); }).find("triangle 3 uses vertex 77"),
            std::string::npos);
}

}  // namespace
}  // namespace raymap
