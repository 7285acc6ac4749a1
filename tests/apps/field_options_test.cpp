#include <fstream>
#include <vector>

#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliFieldOptions : public Cli {};

TEST_F(CliFieldOptions, CoversTheRequestedBox) {
  writeTorus();
  succeed("generate torus.ply -o box.nrrd --voxel-size 0.5 --bounds -4 -3 -1 4 3 1");
  const Grid grid = readField(path("box.nrrd")).grid;
  EXPECT_EQ(grid.dims, glm::ivec3(16, 12, 4));
  EXPECT_DOUBLE_EQ(grid.origin.x, -3.75);
  // Negative numbers are not taken for options.
  succeed("generate torus.ply -o short.nrrd --voxel-size .25 --bounds -.5 -1e0 -.25e+1 .5 +1 -.5");
  const Grid other = readField(path("short.nrrd")).grid;
  EXPECT_EQ(other.dims, glm::ivec3(4, 8, 8));
  EXPECT_DOUBLE_EQ(other.origin.z, -2.375);
}

TEST_F(CliFieldOptions, HasTheRequestedShape) {
  writeTorus();
  const Mesh mesh = readMesh(path("torus.ply"));
  const auto gridOf = [&](const std::string& options) {
    succeed("generate torus.ply -o shape.nrrd --device cpu --shape " + options);
    return readField(path("shape.nrrd")).grid;
  };
  EXPECT_EQ(gridOf("19,18,8 --padding 0.05"),
            fitGrid(mesh, {.dims = glm::ivec3(19, 18, 8), .padding = 0.05}));
  EXPECT_EQ(gridOf("4 4 2 --voxel-size 0.5"), (Grid{glm::ivec3(4, 4, 2), {-0.75, -0.75, -0.25}, 0.5}));
  EXPECT_EQ(gridOf("2 2 2 --bounds 0 0 0 2 1 1"), (Grid{glm::ivec3(2), {0.5, 0, 0}, 1.0}));
}

TEST_F(CliFieldOptions, SamplesCurvesAsAsked) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).x > 2.2; });
  writeMesh(path("torn.ply"), mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  std::ofstream(path("points.txt")) << "# in samples\n 3 -2 1\n\n-100\t0 4   # far away\r\n";
  FieldOptions options{.orientation = Orientation::Keep, .winding = true};
  const auto expectSame = [&](const std::string& arguments) {
    succeed(
        "generate torn.ply -o f.npy --winding w.npy --resolution 24 --device cpu --orientation keep --stats "
        "s.json " +
        arguments);
    const Field expected = generate(mesh, grid, options, {.device = "cpu"}).field;
    // A .npy of winding numbers is read as distances.
    const Field made = readField(path("w.npy"));
    ASSERT_EQ(made.distance.size(), expected.winding.size());
    for (size_t s = 0; s < expected.winding.size(); ++s)
      ASSERT_NEAR(made.distance[s], expected.winding[s], 1e-6f) << arguments << ", sample " << s;
  };
  options.sign = SignMode::Ray;
  expectSame("--sign ray");
  options.sign = SignMode::Paths;
  options.sampling = Sampling::Paper;
  options.passes = 3;
  expectSame("--sign paths --sampling paper --passes 3");
  EXPECT_EQ(json("s.json")["options"]["sampling"], "paper");
  EXPECT_EQ(json("s.json")["options"]["offsets"], Json::array());
  options.offsets = {{3, -2, 1}, {-100, 0, 4}};
  expectSame("--sign paths --sampling paper --passes 3 --offsets points.txt");
  EXPECT_EQ(json("s.json")["options"]["offsets"], Json({{3, -2, 1}, {-100, 0, 4}}));
  options.sign = SignMode::Evolution;
  options.sampling = Sampling::Spread;
  expectSame("--sign evolution --passes 3 --offsets points.txt");
}

TEST_F(CliFieldOptions, NamesTheLineOfABadOffset) {
  writeTorus();
  const auto refuse = [&](const std::string& lines, ErrorCode code, const std::string& message) {
    std::ofstream(path("points.txt")) << lines;
    expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets points.txt", code, message);
  };
  refuse("1 2 3\n\n4 5\n", ErrorCode::Input, "points.txt:3: 2 numbers; a line holds an offset x y z");
  refuse("1 2 3 4\n", ErrorCode::Input, "points.txt:1: 4 numbers");
  refuse("1 2 3\n1 0.5 2\n", ErrorCode::Input, "points.txt:2: number 2 is not a whole number of 32 bits");
  refuse("1 2 3000000000\n", ErrorCode::Input, "points.txt:1: number 3 is not a whole number of 32 bits");
  refuse("1, 2, 3\n", ErrorCode::Input, "points.txt:1: number 1 is not a whole number of 32 bits");
  refuse(std::string(5000, 's') + "\n", ErrorCode::Input, "points.txt:1: number 1 is not");
  refuse("# nothing\n", ErrorCode::Input, "points.txt: it holds no offsets");
  expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets no.txt", ErrorCode::File,
                "no.txt: cannot be opened");
  expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets .", ErrorCode::File, "cannot be opened");
  for (const char* extra : {"--offsets points.txt", "--sampling paper", "--sign rays --sampling paper"})
    expectFailure(std::string("generate torus.ply -o f.nrrd ") + extra, ErrorCode::Usage,
                  "--sampling and --offsets need --sign paths or evolution");
  EXPECT_FALSE(fs::exists(path("f.nrrd")));
}

TEST_F(CliFieldOptions, ThickensSheets) {
  writeMesh(path("square.ply"), makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}},
                                         {{0, 1, 2}, {0, 2, 3}}));
  succeed("mesh square.ply -o plate.stl --thickness 0.4 --voxel-size 0.1");
  EXPECT_NEAR(bounds(readMesh(path("plate.stl"))).size().z, 0.4, 0.02);
  succeed("generate square.ply -o plate.nrrd --thickness 0.4 --voxel-size 0.1 --stats plate.json");
  EXPECT_EQ(json("plate.json")["options"]["thickness"], 0.4);
  EXPECT_EQ(readField(path("plate.nrrd")).grid.dims.x, 52);  // With room for half of the thickness.
  succeed("render square.ply -o plate.png --thickness 0.4 --resolution 32 --size 64 48");
  expectFailure("generate square.ply -o f.nrrd --thickness 0.4 --sign rays", ErrorCode::Usage,
                "place of --sign");
  expectFailure("generate square.ply -o f.nrrd --thickness 0.4 --close-holes", ErrorCode::Usage,
                "needs a sign");
}

}  // namespace
}  // namespace raymap
