#include "cli.h"

namespace raymap {
namespace {

/// A folder with a sound ball, one with a hole, a file of nonsense, and an empty folder.
class CliBatch : public Cli {
 protected:
  void SetUp() override {
    Mesh ball = shapes::sphere(1.0, 3);
    writeMesh(path("ball.obj"), ball);
    ball.triangles.pop_back();
    writeMesh(path("torn.stl"), ball);
    std::ofstream(path("bad.ply")) << "nonsense\n";
    fs::create_directory(path("out"));
  }
  size_t written() const { return size_t(std::distance(fs::directory_iterator(path("out")), {})); }
};

TEST_F(CliBatch, RepairsEachFileByItself) {
  std::ofstream(path("scan.off")) << "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                  << "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const Result all = run("repair ball.obj bad.ply missing.stl torn.stl scan.off -o out/");
  EXPECT_EQ(all.code, exitCode(ErrorCode::File));
  EXPECT_EQ(written(), 3u);
  for (const std::string name : {"ball.obj", "torn.stl"}) {
    succeed("repair " + name + " -o alone-" + name);
    EXPECT_EQ(readBytes(path("out/" + name)), readBytes(path("alone-" + name))) << name;
  }
  EXPECT_NEAR(diagnose(readMesh(path("out/scan.stl"))).signedVolume, 1.0 / 6, 1e-6);  // No .off is written.
  EXPECT_EQ(all.err.rfind("raymap: error: bad.ply: ", 0), 0u) << all.err;
  EXPECT_NE(all.err.find("\nraymap: error: missing.stl: "), std::string::npos) << all.err;
  for (const std::string row :
       {"file +done +triangles +after +volume +seconds +output\n",
        "ball.obj +kept +1,280 +1,280 +4.[0-9]+ +[0-9.]+  out/ball.obj\n",
        "bad.ply +failed +- +- +- +[0-9.]+  -\n", "missing.stl +failed +- +- +- +[0-9.]+  -\n",
        "torn.stl +mended +1,279 +1,280 +4.[0-9]+ +[0-9.]+  out/torn.stl\n"})
    EXPECT_TRUE(std::regex_search(all.out, std::regex("\n" + row))) << row << all.out;
}

TEST_F(CliBatch, MakesAFieldOfEachMesh) {
  const std::string grid = " --resolution 16";
  const Result all =
      run("generate ball.obj bad.ply torn.stl -o out/ --format nrrd --stats all.json --sign paths" + grid);
  EXPECT_EQ(all.code, exitCode(ErrorCode::Input)) << all.err;
  EXPECT_EQ(written(), 2u);
  succeed("generate torn.stl -o alone.nrrd --sign paths" + grid);
  EXPECT_EQ(readBytes(path("out/torn.nrrd")), readBytes(path("alone.nrrd")));
  EXPECT_TRUE(std::regex_search(all.out, std::regex("torn.stl +made +1,279 +- +- +[0-9.]+  out/torn.nrrd\n")))
      << all.out;
  const Json figures = json("all.json");
  ASSERT_EQ(figures.size(), 3u);
  EXPECT_EQ(figures[2]["grid"]["dims"], Json({16, 16, 16}));
  EXPECT_EQ(figures[2]["result"], "out/torn.nrrd");
  EXPECT_EQ(figures[1]["error"], "input");
  succeed("generate ball.obj -o out/" + grid);
  EXPECT_TRUE(fs::exists(path("out/ball.vdb")));
  expectFailure("generate ball.obj torn.stl -o both.vdb", ErrorCode::Usage, "name a folder");
  expectFailure("generate ball.obj torn.stl -o out/ --winding w.npy", ErrorCode::Usage,
                "--winding names one file");
  expectFailure("generate ball.obj -o out/ --frames 0:3", ErrorCode::Usage, "%04d");
  expectFailure("generate ball.obj -o out/ --format nrrd --half", ErrorCode::Usage, "--half is for");
}

TEST_F(CliBatch, SplitsEachMesh) {
  const Mesh plate = shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({2, 0, 0}, {4, 1, 1}));
  writeMesh(path("plate.ply"), plate);
  const Result all = succeed("repair plate.ply ball.obj -o out/ --split --stats all.json");
  EXPECT_EQ(written(), 3u);
  EXPECT_EQ(diagnose(readMesh(path("out/plate_2.ply"))).signedVolume, 2.0);
  EXPECT_TRUE(std::regex_search(all.out, std::regex("\n2 +2 x 1 x 1 +12 +2  out/plate_2.ply\n"))) << all.out;
  EXPECT_NE(all.out.find("out/plate.ply in 2 parts\n"), std::string::npos) << all.out;
  const Json figures = json("all.json");
  EXPECT_EQ(figures[0]["parts"][1]["file"], "out/plate_2.ply");
  EXPECT_EQ(figures[0]["parts"][1]["volume"], 2.0);
  EXPECT_EQ(figures[1]["parts"].size(), 1u);
  EXPECT_TRUE(figures[1]["result"].is_null());
  succeed("convert plate.ply ball.obj -o out/ --split --format stl");
  EXPECT_EQ(written(), 6u);
}

TEST_F(CliBatch, PrintsAnArrayOfFigures) {
  const Result all =
      run("repair torn.stl bad.ply ball.obj -o out --json --height 5 --remesh --resolution 32");
  EXPECT_EQ(all.code, exitCode(ErrorCode::Input));
  const Json figures = Json::parse(all.out);
  ASSERT_EQ(figures.size(), 3u);
  EXPECT_EQ(figures[0]["mesh"], "torn.stl");
  EXPECT_EQ(figures[0]["result"], "out/torn.stl");
  EXPECT_EQ(figures[0]["after"]["watertight"], true);
  EXPECT_EQ(figures[1]["mesh"], "bad.ply");
  EXPECT_EQ(figures[1]["error"], "input");
  EXPECT_NE(figures[1]["message"].get<std::string>().find("bad.ply"), std::string::npos);
  EXPECT_EQ(figures[2]["options"]["height"], 5.0);
  EXPECT_EQ(figures[2]["options"]["fit"], nullptr);
  EXPECT_NEAR(figures[2]["options"]["scale"].get<double>(), 2.5, 1e-6);
  EXPECT_NEAR(bounds(readMesh(path("out/ball.obj"))).size().z, 5.0, 0.1);
  succeed("repair ball.obj -o out/ --overwrite --stats one.json");  // A folder gives an array, always.
  EXPECT_EQ(json("one.json").size(), 1u);
}

TEST_F(CliBatch, SimplifiesAndConvertsEachFile) {
  EXPECT_EQ(run("simplify ball.obj torn.stl -o out/ --triangles 200").code, exitCode(ErrorCode::Input));
  EXPECT_EQ(written(), 1u);
  EXPECT_LE(readMesh(path("out/ball.obj")).triangles.size(), 200u);
  const std::string text = succeed("convert ball.obj torn.stl -o out/ --format .3MF").out;
  EXPECT_NE(text.find("\ntorn.stl  converted      1,279  1,279"), std::string::npos) << text;
  for (const std::string name : {"ball", "torn"}) {
    succeed("convert " + name + (name == "ball" ? ".obj" : ".stl") + " -o alone.3mf");
    EXPECT_EQ(readMesh(path("out/" + name + ".3mf")).vertices, readMesh(path("alone.3mf")).vertices) << name;
  }
}

TEST_F(CliBatch, MakesTheFolder) {
  succeed("convert ball.obj torn.stl -o new/deep/ --format ply");
  EXPECT_EQ(readMesh(path("new/deep/torn.ply")).triangles.size(), 1279u);
}

TEST_F(CliBatch, RefusesWhatCannotBecomeFilesOfAFolder) {
  const auto usage = ErrorCode::Usage;
  writeMesh(path("out/ball.ply"), shapes::sphere(1.0, 2));
  const std::string before = readBytes(path("ball.obj"));
  expectFailure("repair ball.obj out/ball.ply -o out", usage,
                "ball.obj and out/ball.ply would have the same");
  expectFailure("repair ball.obj torn.stl -o ball.ply", usage, "is one file for 2 meshes; name a folder");
  expectFailure("repair ball.obj torn.stl -o .", usage, "is the input ball.obj; to replace it: --overwrite");
  expectFailure("repair ball.obj torn.stl -o none/ --stats x.txt", usage, "must end in .json");
  EXPECT_FALSE(std::filesystem::exists(path("none")));
  expectFailure("repair ball.obj torn.stl -o out/ --format off", usage, "--format off: must be one of .ply");
  expectFailure("repair - torn.stl -o out/", usage, "standard input has no name");
  EXPECT_EQ(written(), 1u);
  EXPECT_EQ(readBytes(path("ball.obj")), before);
  succeed("convert ball.obj torn.stl -o . --scale 2 --overwrite");
  EXPECT_NE(readBytes(path("ball.obj")), before);
}

}  // namespace
}  // namespace raymap
