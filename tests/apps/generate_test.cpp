#include <algorithm>
#include <cfloat>
#include <fstream>
#include <sstream>
#include <vector>

#include "broken_meshes.h"
#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliGenerate : public Cli {};

TEST_F(CliGenerate, MakesAFieldOfAMesh) {
  writeTorus();
  const Result result = succeed(
      "generate torus.ply -o torus.nrrd --resolution 40 --triangle-ids ids.npy --winding w.npy "
      "--confidence c.npy --stats stats.json");
  EXPECT_NE(result.out.find("wrong with it: nothing"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("wrote torus.nrrd"), std::string::npos) << result.out;
  const Field field = readField(path("torus.nrrd"));
  EXPECT_EQ(std::max({field.grid.dims.x, field.grid.dims.y, field.grid.dims.z}), 40);
  const glm::ivec3 middle = field.grid.dims / 2;
  EXPECT_NEAR(field.distance[field.grid.index(middle)], 1.3, field.grid.spacing);  // In the torus's hole,
  const int inside = int((2.0 - field.grid.origin.x) / field.grid.spacing);
  EXPECT_LT(field.distance[field.grid.index({inside, middle.y, middle.z})], -0.5);  // and in its tube.
  for (const char* name : {"ids.npy", "w.npy", "c.npy"}) EXPECT_TRUE(fs::exists(path(name))) << name;
}

TEST_F(CliGenerate, WarnsIfNothingIsInside) {
  writeMesh(path("plate.ply"), shapes::box({-1, -1, 0.04}, {1, 1, 0.06}));
  const std::string make =
      "generate plate.ply -o plate.npz --device cpu --bounds -1.2 -1.2 -.25 1.2 1.2 .25 ";
  const Result result = runQuietly(make + "--voxel-size 0.1");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.err,
            "raymap: warning: no sample is inside, because the mesh is thinner than the spacing 0.1; use a "
            "spacing of 0.0098 (--voxel-size 0.0098)\n");
  succeed(make + "--voxel-size 0.0098");
  const Field field = readField(path("plate.npz"));
  EXPECT_LT(*std::ranges::min_element(field.distance), 0.0f);
}

// With so many samples, only those near the surface are made.
TEST_F(CliGenerate, MakesANarrowBandOfManySamples) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Mesh mesh = shapes::sphere(1.0, 4);
  writeMesh(path("ball.ply"), mesh);
  const std::string make = "generate ball.ply --band 3 --device cpu --resolution ";
  const auto stages = [&](const std::string& options) {
    const Result result = succeed(make + options + " --stats s.json");
    EXPECT_NE(result.out.find("wrote "), std::string::npos) << result.out;
    std::string names;
    const auto figures = json("s.json");
    for (const auto& stage : figures["stats"]["stages"]) names += stage["name"].get<std::string>() + ' ';
    return names;
  };
  EXPECT_EQ(stages("60 -o few.vdb").find("narrow_band"), std::string::npos);
  EXPECT_NE(stages("260 -o many.vdb").find("narrow_band"), std::string::npos);
  const Field field = readField(path("many.vdb"));
  const Field band = Surface(mesh).generateBand(field.grid);
  EXPECT_EQ(field.clampDistance, 3.0 * field.grid.spacing);
  size_t different = 0;
  for (size_t s = 0; s < field.distance.size(); ++s)
    different += field.distance[s] !=
                 band.distanceAt({int(s) % field.grid.dims.x, int(s) / field.grid.dims.x % field.grid.dims.y,
                                  int(s) / field.grid.dims.x / field.grid.dims.y});
  EXPECT_EQ(different, 0u);
  // More than 32 bits can number.
  const Result huge = succeed(
      "generate ball.ply --band 3 --device cpu --voxel-size 0.02 --bounds -25 -25 -25 25 25 25 -o huge.vdb");
  EXPECT_NE(huge.out.find("grid: 2500 x 2500 x 2500 = 15,625,000,000 samples"), std::string::npos)
      << huge.out;
}

TEST_F(CliGenerate, StoresNumbersIn16Bits) {
  if (!hasFieldFormat(".nvdb")) GTEST_SKIP();
  writeTorus();
  const std::string generate = "generate torus.ply --resolution 30 --band 3 -o ";
  succeed(generate + "whole.nrrd");
  succeed(generate + "half.nvdb --half --winding winding.nrrd");
  const Field whole = readField(path("whole.nrrd")), half = readField(path("half.nvdb"));
  EXPECT_EQ(half.grid, whole.grid);
  for (size_t s = 0; s < whole.distance.size(); ++s)
    ASSERT_NEAR(half.distance[s], whole.distance[s], 1.02 * whole.clampDistance / 65535.0) << s;
  EXPECT_FALSE(std::ranges::equal(half.distance, whole.distance));
  expectFailure(
      generate + "half.nrrd --half", ErrorCode::Usage,
      "--half is for a .vdb, .nvdb, .npy or .npz, and half.nrrd is none: its format has no type for "
      "numbers of 16 bits");
  expectFailure(generate + "half.vti --half", ErrorCode::Usage, "half.vti is none");
  succeed(generate + "half.npy --half --winding winding.vti");
  EXPECT_EQ(std::filesystem::file_size(path("half.npy")), 128 + 2 * whole.distance.size());
  EXPECT_EQ(readField(path("winding.vti")).winding.size(), whole.distance.size());
}

TEST_F(CliGenerate, AlignsSamples) {
  writeTorus();
  succeed("generate torus.ply -o a.npz --voxel-size 0.3 --align");
  const Grid grid = readField(path("a.npz")).grid;
  EXPECT_EQ(grid, fitGrid(readMesh(path("torus.ply")), {.voxelSize = 0.3, .align = true}));
  EXPECT_EQ(std::remainder(grid.origin.x, 8 * 0.3), 0.0);
  expectFailure("generate torus.ply -o b.npz --shape 9 9 9 --align", ErrorCode::Usage,
                "--shape and --align cannot be used together");
}

TEST_F(CliGenerate, MakesAFarFieldOfAnEmptyMesh) {
  std::ofstream(path("empty.obj")) << "v 0 0 0\n";
  std::ofstream(path("empty.off")) << "OFF\n0 0 0\n";
  const std::string make = "generate empty.obj -o empty.npz ", box = "--bounds 0 0 0 2 1 1 --resolution 8 ";
  expectFailure(make + box, ErrorCode::Input,
                "empty.obj: the file has no triangles; --allow-empty makes a field that is far everywhere");
  expectFailure(make + "--allow-empty", ErrorCode::Usage, "it has no bounds; add --bounds");
  expectFailure(make + box + "--allow-empty --report-picture a.png", ErrorCode::Usage, "--report-picture");
  expectFailure("info empty.obj", ErrorCode::Input, "the file has no triangles");
  EXPECT_FALSE(fs::exists(path("empty.npz")));
  const Result result = succeed(make + box +
                                "--allow-empty --winding w.npy --confidence c.npy --triangle-ids t.npy "
                                "--stats s.json --report r.json");
  EXPECT_NE(result.out.find("empty.obj: no triangles, so the field is far everywhere\n"), std::string::npos);
  EXPECT_NE(result.out.find("grid: 8 x 4 x 4"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("wrote t.npy"), std::string::npos) << result.out;
  EXPECT_EQ(json("s.json")["diagnostics"]["triangles"], 0);
  EXPECT_EQ(json("r.json")["guessed_share"], 0.0);
  const auto expectAll = [&](const std::string& name, float value) {
    const Field field = readField(path(name));
    EXPECT_EQ(field.distance.size(), 128u) << name;
    EXPECT_TRUE(std::ranges::all_of(field.distance, [&](float d) { return d == value; })) << name;
  };
  expectAll("empty.npz", FLT_MAX);
  succeed("convert empty.npz -o twice.npz --scale 2");
  expectAll("twice.npz", FLT_MAX);
  for (const std::string& extension : fieldExtensions()) {
    const std::string name = "far" + extension;
    succeed("generate empty.off -o " + name + " --allow-empty --invert " + box);
    expectAll(name, -FLT_MAX);
    succeed("generate empty.off -o " + name + " --allow-empty --band 2 " + box);
    expectAll(name, 0.5f);
    succeed("info " + name);
  }
}

TEST_F(CliGenerate, ReportsStatistics) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  mesh.triangles.pop_back();
  writeMesh(path("torn.ply"), mesh);
  const std::string summary =
      succeed("generate torn.ply -o torn.nrrd --voxel-size 0.25 --threads 2 --stats stats.json").out;
  const Json stats = json("stats.json");
  const Grid grid = readField(path("torn.nrrd")).grid;
  EXPECT_EQ(stats["grid"]["dims"], Json({grid.dims.x, grid.dims.y, grid.dims.z}));
  EXPECT_EQ(stats["grid"]["samples"], grid.sampleCount());
  EXPECT_EQ(stats["grid"]["spacing"], 0.25);
  EXPECT_EQ(stats["diagnostics"]["boundary_edges"], 3);
  EXPECT_NE(summary.find("size 5.4 x 5.4 x 1.4, wrong with it: 3 boundary edges\n"), std::string::npos)
      << summary;
  Json info = Json::parse(succeed("info torn.ply --json").out);
  EXPECT_EQ(info["hole_count"], 1);
  EXPECT_EQ(info["holes"][0]["edges"], 3);
  EXPECT_EQ(info["self_intersections"]["pairs"], 0);
  EXPECT_TRUE(info["unit"].is_null());
  for (const char* key : {"self_intersections", "unit", "verdict", "file"}) info.erase(key);
  EXPECT_EQ(stats["diagnostics"], info);
  EXPECT_EQ(stats["options"]["threads"], 2);
  EXPECT_GT(stats["stats"]["doubtful_share"], 0.0);
  EXPECT_GT(stats["peak_memory_bytes"], grid.sampleCount() * sizeof(float));
  double sum = 0.0;
  for (const Json& stage : stats["stats"]["stages"]) sum += stage["milliseconds"].get<double>();
  EXPECT_GT(stats["stats"]["stages"].size(), 3u);
  EXPECT_LE(sum, stats["stats"]["milliseconds"].get<double>() * 1.001);
}

TEST_F(CliGenerate, ShowsWhereTheTimeGoes) {
  writeTorus();
  std::istringstream out(
      run("generate torus.ply -o torus.nrrd --resolution 40 --device cpu --stats stats.json --verbose").out);
  std::vector<std::string> names;
  for (std::string line; std::getline(out, line);) {
    if (!line.starts_with("  ")) continue;
    std::istringstream words(line);
    std::string name, unit;
    double milliseconds = -1.0;
    words >> name >> milliseconds >> unit;
    EXPECT_EQ(unit, "ms") << line;
    EXPECT_GE(milliseconds, 0.0) << line;
    names.push_back(name);
  }
  ASSERT_GT(names.size(), 9u);
  EXPECT_EQ(std::vector(names.begin(), names.begin() + 4),
            (std::vector<std::string>{"load", "diagnose", "fit", "begin"}));
  EXPECT_EQ(std::vector(names.end() - 4, names.end()),
            (std::vector<std::string>{"write", "report", "other", "elapsed"}));
  const Json steps = json("stats.json")["steps"];
  ASSERT_EQ(steps.size(), names.size() - 3);  // It is written in the step "report".
  for (size_t s = 0; s < steps.size(); ++s) EXPECT_EQ(steps[s]["name"], names[s]);
  EXPECT_EQ(succeed("generate torus.ply -o torus.nrrd --resolution 40 --device cpu").out.find("  report  "),
            std::string::npos);
}

TEST_F(CliGenerate, ReportsDefects) {
  Mesh mesh = shapes::sphere(1.0, 3);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.8; });
  std::swap(mesh.triangles[9].x, mesh.triangles[9].y);
  writeMesh(path("torn.ply"), mesh);
  succeed("generate torn.ply -o torn.nrrd --resolution 24 --report report.json --report-picture report.png");
  const Json report = json("report.json");
  EXPECT_EQ(report["diagnostics"]["flipped_faces"], 1);
  EXPECT_EQ(report["diagnostics"]["hole_count"], 1);
  EXPECT_EQ(report["diagnostics"]["self_intersections"]["pairs"], 0);
  EXPECT_GT(report["stats"]["doubtful_share"], 0.01);
  EXPECT_GT(report["guessed_share"], 0.0);
  EXPECT_LT(report["guessed_share"], 0.9);
  EXPECT_GT(fs::file_size(path("report.png")), 1000u);
  succeed("info torn.ply --picture torn.png --size 100 80 --up 0 0 1 --direction 0 1 0");
  EXPECT_GT(fs::file_size(path("torn.png")), 500u);
  expectFailure("info torn.ply --picture torn.jpg", ErrorCode::Usage, "torn.jpg");
  expectFailure("info torn.ply --picture torn.png --direction 0 1 0", ErrorCode::Usage, "two different");
}

TEST_F(CliGenerate, ClosesHoles) {
  Mesh mesh = shapes::sphere(1.0, 4);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.8; });
  writeMesh(path("open.ply"), mesh);
  const Result result =
      succeed("generate open.ply -o open.nrrd --resolution 32 --close-holes --device cpu --stats stats.json");
  EXPECT_NE(result.out.find("closed holes:"), std::string::npos) << result.out;
  const Json stats = json("stats.json");
  EXPECT_TRUE(stats["options"]["close_holes"]);
  EXPECT_NEAR(stats["stats"]["patch_area"], 1.13, 0.1);
  EXPECT_GT(stats["stats"]["patch_triangles"], 100);
  expectFailure("generate open.ply -o none.nrrd --close-holes --sign none", ErrorCode::Usage, "needs a sign");
}

TEST_F(CliGenerate, MakesASolidOfADoubleSidedMesh) {
  const Mesh ball = shapes::sphere(1.0, 4);
  const size_t faces = ball.triangles.size();
  const auto least = [](const fs::path& file) {
    const Field field = readField(file);
    return *std::min_element(field.distance.begin(), field.distance.end());
  };
  writeMesh(path("ball.ply"), withDoubledFaces(ball, 1.0, 1));
  const std::string info = succeed("info ball.ply").out;
  EXPECT_NE(info.find("\ndouble-sided faces       10,240\n"), std::string::npos) << info;
  EXPECT_EQ(Json::parse(succeed("info ball.ply --json").out)["double_sided_faces"], 2 * faces);
  const std::string text =
      succeed("generate ball.ply -o ball.nrrd --resolution 48 --device cpu --stats s.json --report r.json")
          .out;
  EXPECT_NE(text.find("10,240 double-sided faces"), std::string::npos) << text;
  EXPECT_NE(text.find("orientation: left out 5,120 faces with the corners of another\n"), std::string::npos)
      << text;
  for (const char* file : {"s.json", "r.json"}) EXPECT_EQ(json(file)["stats"]["left_out_faces"], faces);
  EXPECT_LT(least(path("ball.nrrd")), -0.95f);
  const std::string keep =
      "generate ball.ply -o kept.nrrd --resolution 48 --device cpu --orientation keep --stats s.json";
  EXPECT_NE(runQuietly(keep).err.find("no sample is inside, because the faces enclose nothing"),
            std::string::npos);
  EXPECT_EQ(json("s.json")["stats"]["left_out_faces"], 0);
  EXPECT_GT(least(path("kept.nrrd")), 0.0f);
  const std::string mended = succeed("repair ball.ply -o solid.stl --resolution 64").out;
  EXPECT_NE(mended.find("removed 5,120 degenerate or repeated faces"), std::string::npos) << mended;
  const std::string made =
      succeed("repair ball.ply -o solid.stl --resolution 64 --remesh --stats solid.json").out;
  EXPECT_NE(made.find("5,120 faces with the corners of another"), std::string::npos) << made;
  EXPECT_EQ(json("solid.json")["stats"]["left_out_faces"], faces);
}

TEST_F(CliGenerate, KeepsFiguresForExperts) {
  writeTorus();
  Mesh torn = readMesh(path("torus.ply"));
  torn.triangles.resize(torn.triangles.size() - 40);
  for (size_t t = 0; t < 200; ++t) std::swap(torn.triangles[t].x, torn.triangles[t].y);
  writeMesh(path("torn.ply"), torn);
  const std::string command = "generate torn.ply -o f.nrrd --resolution 24 --device cpu";
  const std::string brief = run(command).out, full = run(command + " --verbose").out;
  const std::string sure = run(command + " --confidence c.nrrd").out;
  const std::string sign =
      "\nsign: estimated at [0-9.]+ % of the samples, which see holes or contradicting faces";
  EXPECT_TRUE(std::regex_search(brief, std::regex(sign + "; --confidence FILE writes how certain it is\n")))
      << brief;
  EXPECT_TRUE(std::regex_search(sure, std::regex(sign + "\n"))) << sure;
  EXPECT_NE(brief.find("\norientation: reversed 200 faces that pointed the wrong way\n"), std::string::npos)
      << brief;
  for (const char* words :
       {"  their six rays disagree\n", "  misfit of the crossings: ", "  exact_distance "}) {
    EXPECT_EQ(brief.find(words), std::string::npos) << brief;
    EXPECT_NE(full.find(words), std::string::npos) << full;
  }
  EXPECT_EQ(succeed("generate torus.ply -o g.nrrd --resolution 24 --device cpu").out.find("sign:"),
            std::string::npos);
}

TEST_F(CliGenerate, SaysThatNoOrientationFits) {
  Mesh fan = shapes::sphere(1.0, 5);  // All faces meet in the centre.
  fan.vertices.emplace_back(0.0f);
  for (glm::uvec3& t : fan.triangles) t.z = uint32_t(fan.vertices.size() - 1);
  writeMesh(path("fan.ply"), withFlippedFaces(fan, 0.5, 5));
  const std::string text =
      run("generate fan.ply -o fan.nrrd --resolution 40 --device cpu --stats s.json").err;
  EXPECT_TRUE(
      text.starts_with("raymap: warning: the faces contradict each other, whichever way each of them"))
      << text;
  EXPECT_TRUE(text.ends_with("find out what is wrong with the mesh, and mend it (raymap info MESH)\n"))
      << text;
  EXPECT_EQ(json("s.json")["stats"]["orientation_fits"], false);
  EXPECT_EQ(json("s.json")["stats"]["turned_faces"], 0);
  EXPECT_GT(json("s.json")["stats"]["misfit"], 0.5);
}

TEST_F(CliGenerate, KeepsAllArraysInOneFile) {
  writeTorus();
  succeed(
      "generate torus.ply --resolution 16 -o f.npz --winding w.nrrd --confidence c.nrrd --triangle-ids "
      "t.nrrd");
  const Field all = readField(path("f.npz"));
  EXPECT_TRUE(std::ranges::equal(all.winding, readField(path("w.nrrd")).winding));
  EXPECT_TRUE(std::ranges::equal(all.confidence, readField(path("c.nrrd")).confidence));
  EXPECT_TRUE(std::ranges::equal(all.triangle, readField(path("t.nrrd")).triangle));
  succeed("convert f.npz g.vti");
  succeed("compare f.npz g.vti --as triangle");
  EXPECT_TRUE(std::ranges::equal(readField(path("g.vti")).triangle, all.triangle));
}

TEST_F(CliGenerate, TakesTheNumberOfThreadsFromTheVariable) {
  writeTorus();
  const std::string generate = "generate torus.ply -o f.nrrd --resolution 16 --device cpu";
  succeed(generate + " --threads 100000");
  const std::string all = readBytes(path("f.nrrd"));
  EXPECT_EQ(run(generate, "RAYMAP_THREADS=1").code, 0);
  EXPECT_EQ(readBytes(path("f.nrrd")), all);
  const Result wrong = run(generate, "RAYMAP_THREADS=all");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("the environment variable RAYMAP_THREADS is 'all'"), std::string::npos)
      << wrong.err;
}

}  // namespace
}  // namespace raymap
