// Runs the program as a user would.

#include <gtest/gtest.h>
#include <raymap/raymap.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>

#include "broken_meshes.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Result {
  int code;
  std::string out, err;
};

bool hasFieldFormat(const std::string& extension) {
  const std::vector<std::string> known = fieldExtensions();
  return std::find(known.begin(), known.end(), extension) != known.end();
}

class Cli : public ::testing::Test {
 protected:
  /// Runs `raymap arguments` in the folder, with `prefix` before the command.
  Result run(const std::string& arguments, const std::string& prefix = "") const {
    const std::string command = "cd '" + folder_.path().string() + "' && " + prefix +
                                " '" RAYMAP_BINARY "' " + arguments + " >.out 2>.err </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readBytes(path(".out")), readBytes(path(".err"))};
  }

  /// Runs a line of a shell in the folder. $R is the program.
  Result shell(const std::string& line) const {
    std::ofstream(path(".line")) << "R='" RAYMAP_BINARY "'\n" << line << "\n";
    const std::string command =
        "cd '" + folder_.path().string() + "' && bash .line >.out 2>.err </dev/null; e=$?; rm .line; exit $e";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readBytes(path(".out")), readBytes(path(".err"))};
  }

  Result succeed(const std::string& arguments) const {
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << arguments << "\n" << result.err;
    EXPECT_EQ(result.err, "") << arguments;
    return result;
  }

  /// Expects one line on stderr that contains `message`, nothing on stdout, and the code.
  void expectFailure(const std::string& arguments, ErrorCode code, const std::string& message) const {
    SCOPED_TRACE(arguments);
    const Result result = run(arguments);
    EXPECT_EQ(result.code, static_cast<int>(code)) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.rfind("raymap: error: ", 0), 0u) << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  Json json(const std::string& name) const { return Json::parse(readBytes(path(name))); }
  void writeTorus() const { writeMesh(path("torus.ply"), shapes::torus(2.0, 0.7, 40, 24)); }
  /// Returns the names of all files in the folder, hidden ones too, but the captured output.
  size_t fileCount() const {
    size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      count += entry.path().filename() != ".out" && entry.path().filename() != ".err" ? 1 : 0;
    return count;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Cli, PrintsHelpAndVersion) {
  EXPECT_NE(succeed("--version").out.find("raymap 0."), std::string::npos);
  const std::string help = succeed("--help").out;
  for (const char* word : {"generate", "info", "query", "mesh", "render", "repair", "compare", "convert",
                           "example", "devices", "Exit codes"})
    EXPECT_NE(help.find(word), std::string::npos) << word;
  const std::string generate = succeed("generate --help").out;
  for (const char* option :
       {"--output",       "--resolution", "--voxel-size", "--bounds",    "--padding",
        "--distance",     "--sign",       "--passes",     "--threshold", "--band",
        "--close-holes",  "--invert",     "--device",     "--threads",   "--memory-limit",
        "--triangle-ids", "--winding",    "--confidence", "--stats",     "Examples:"})
    EXPECT_NE(generate.find(option), std::string::npos) << option;
  const std::string render = succeed("render --help").out;
  for (const char* option :
       {"--cut", "--shell", "--slice", "--index", "--resolution", "--size", "--direction", "--device"})
    EXPECT_NE(render.find(option), std::string::npos) << option;
}

TEST_F(Cli, ListsDevices) {
  const Json json = Json::parse(succeed("devices --json").out);
  const Json& devices = json["devices"];
  ASSERT_GE(devices.size(), 1u);
  EXPECT_GE(devices[0]["threads"], 1);
  EXPECT_TRUE(devices[0]["usable"]);
  EXPECT_EQ(json.contains("note"), devices.size() == 1);
  for (size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i]["id"], i == 0 ? "cpu" : "vulkan:" + std::to_string(i - 1));
    EXPECT_EQ(devices[i]["usable"], !devices[i].contains("problem"));
    if (devices[i]["id"] == json["auto"]) {
      EXPECT_TRUE(devices[i]["usable"]);
      EXPECT_NE(devices[i]["type"], "software");
    }
  }
  const std::string text = succeed("devices").out;
  EXPECT_NE(text.find("auto"), std::string::npos) << text;
  for (const Json& device : devices)
    EXPECT_NE(text.find(device["name"].get<std::string>()), std::string::npos) << text;
}

TEST_F(Cli, TestsDevices) {
  std::string gpu;
  const Json all = Json::parse(succeed("devices --json").out);
  for (const Json& device : all["devices"])
    if (device["id"] != "cpu" && device["usable"]) gpu = device["id"];
  if (gpu.empty()) GTEST_SKIP() << "no GPU";
  const std::string cache = "RAYMAP_CACHE='" + path("cache").string() + "'";
  const Result tested = run("devices --json --test " + gpu, cache);
  EXPECT_EQ(tested.code, 0) << tested.out;
  const Json json = Json::parse(tested.out).at(0);
  EXPECT_EQ(json["id"], gpu);
  EXPECT_EQ(json["test"], "passed");
  EXPECT_EQ(json["raymap"], version().text);
  for (const char* key : {"name", "driver", "vulkan", "subgroup_size"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_GT(json["checks"].size(), 20u);
  for (const Json& check : json["checks"]) EXPECT_TRUE(check["passed"]) << check;
  EXPECT_TRUE(fs::exists(path("cache")));
  const Result listed = run("devices", cache);
  EXPECT_NE(listed.out.find("test: passed"), std::string::npos) << listed.out;
}

TEST_F(Cli, TestsNothingButGpus) {
  expectFailure("devices --test cpu", ErrorCode::Usage, "'cpu' is not the name of a GPU");
  expectFailure("devices --test vulkan:99", ErrorCode::Unsupported, "vulkan:99");
  const Result none = run("devices --test", "VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere");
  EXPECT_EQ(none.code, static_cast<int>(ErrorCode::Unsupported));
  EXPECT_NE(none.err.find("there is no GPU to test: "), std::string::npos) << none.err;
}

TEST_F(Cli, SaysWhyThereIsNoGpu) {
  const Result result = run("devices --json", "VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere");
  EXPECT_EQ(result.code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["auto"], "cpu");
  EXPECT_EQ(json["devices"].size(), 1u);
  EXPECT_FALSE(json["note"].get<std::string>().empty());
}

TEST_F(Cli, WritesTheExampleMesh) {
  succeed("example -o globe.ply");
  const Json whole = Json::parse(succeed("info globe.ply --json").out);
  EXPECT_TRUE(whole["watertight"]);
  EXPECT_TRUE(whole["consistently_oriented"]);
  EXPECT_EQ(whole["degenerate_faces"], 0);
  EXPECT_EQ(whole["components"], 2);
  EXPECT_GT(whole["triangles"], 90000);
  succeed("example -o torn.ply --holes");
  EXPECT_GT(Json::parse(succeed("info torn.ply --json").out)["boundary_edges"], 300);
}

TEST_F(Cli, ReportsDefects) {
  Mesh mesh = shapes::sphere(1.0, 3);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.8; });
  std::swap(mesh.triangles[9].x, mesh.triangles[9].y);
  writeMesh(path("torn.ply"), mesh);
  succeed("generate torn.ply -o torn.nrrd --resolution 24 --report report.json --report-picture report.png");
  const Json report = json("report.json");
  EXPECT_EQ(report["diagnostics"]["flipped_faces"], 1);
  EXPECT_EQ(report["diagnostics"]["hole_count"], 1);
  EXPECT_EQ(report["self_intersections"]["pairs"], 0);
  EXPECT_GT(report["signs"]["doubtful_share"], 0.01);
  EXPECT_GT(report["signs"]["guessed_share"], 0.0);
  EXPECT_LT(report["signs"]["guessed_share"], 0.9);
  EXPECT_GT(fs::file_size(path("report.png")), 1000u);
  succeed("info torn.ply --picture torn.png --size 100 80 --up 0 0 1 --direction 0 1 0");
  EXPECT_GT(fs::file_size(path("torn.png")), 500u);
  expectFailure("info torn.ply --picture torn.jpg", ErrorCode::Usage, "torn.jpg");
  expectFailure("info torn.ply --picture torn.png --direction 0 1 0", ErrorCode::Usage, "two different");
}

TEST_F(Cli, ClosesHoles) {
  Mesh mesh = shapes::sphere(1.0, 4);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.8; });
  writeMesh(path("open.ply"), mesh);
  const Result result =
      succeed("generate open.ply -o open.nrrd --resolution 32 --close-holes --device cpu --stats stats.json");
  EXPECT_NE(result.out.find("closed holes:"), std::string::npos) << result.out;
  const Json stats = json("stats.json");
  EXPECT_TRUE(stats["options"]["close_holes"]);
  EXPECT_NEAR(stats["patch"]["area"], 1.13, 0.1);
  EXPECT_GT(stats["patch"]["triangles"], 100);
  expectFailure("generate open.ply -o none.nrrd --close-holes --sign none", ErrorCode::Usage, "needs a sign");
}

TEST_F(Cli, MakesAFieldOfAMesh) {
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

TEST_F(Cli, ReportsStatistics) {
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
  for (const char* key : {"self_intersections", "unit", "verdict"}) info.erase(key);
  EXPECT_EQ(stats["diagnostics"], info);
  EXPECT_EQ(stats["options"]["threads"], 2);
  EXPECT_GT(stats["doubtful_share"], 0.0);
  EXPECT_GT(stats["peak_memory_bytes"], grid.sampleCount() * sizeof(float));
  double sum = 0.0;
  for (const Json& stage : stats["stages"]) sum += stage["ms"].get<double>();
  EXPECT_GT(stats["stages"].size(), 3u);
  EXPECT_LE(sum, stats["total_ms"].get<double>() * 1.001);
}

TEST_F(Cli, ShowsWhereTheTimeGoes) {
  writeTorus();
  std::istringstream out(
      succeed("generate torus.ply -o torus.nrrd --resolution 40 --device cpu --stats stats.json").out);
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
  EXPECT_GE(json("stats.json")["mesh"]["diagnose_ms"], 0.0);
  EXPECT_EQ(succeed("generate torus.ply -o torus.nrrd --resolution 40 --device cpu").out.find("  report  "),
            std::string::npos);
}

TEST_F(Cli, WritesNamesThatAreNoText) {
  writeTorus();
  const std::string name = "t\xff.ply";
  fs::rename(path("torus.ply"), path(name));
  EXPECT_EQ(shell("$R generate $'t\\xff.ply' -o f.nrrd --resolution 8 --stats s.json --report r.json").code,
            0);
  EXPECT_EQ(json("s.json")["mesh"]["file"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(json("r.json")["mesh"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(shell("$R repair $'t\\xff.ply' -o s.stl --resolution 16 --stats s.json").code, 0);
  EXPECT_EQ(json("s.json")["mesh"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(shell("$R query $'t\\xff.ply' $'t\\xff.ply' -o r.csv --stats s.json").code, 0);
  EXPECT_EQ(json("s.json")["points"]["file"], "t\xef\xbf\xbd.ply");
}

TEST_F(Cli, SendsNoControlCharactersOfFileNamesToTheTerminal) {
  writeTorus();
  const std::string name = "t\x1b[31m\n\x7f\xc2\x9b\\'.ply",
                    quoted = "$'t\\x1b[31m\\n\\x7f\\xc2\\x9b\\\\\\'.ply'";
  const std::string shown = "t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\'.ply";
  Mesh torn = readMesh(path("torus.ply"));
  torn.triangles.pop_back();
  writeMesh(path(name), torn);
  const auto expectPlain = [&](const Result& result, int code) {
    const std::string text = result.out + result.err;
    EXPECT_EQ(result.code, code) << text;
    EXPECT_NE(text.find(shown), std::string::npos) << text;
    for (size_t i = 0; i < text.size(); ++i)
      EXPECT_TRUE(text[i] == '\n' || (static_cast<unsigned char>(text[i]) >= 0x20 && text[i] != '\x7f'))
          << text;
    EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos) << text;
    EXPECT_EQ(text.find(".ply\n'"), std::string::npos) << text;
  };
  expectPlain(shell("$R generate " + quoted + " -o f.nrrd --resolution 8 --device cpu"), 0);
  expectPlain(shell("$R query " + quoted + " " + quoted + " -o " + quoted + " --overwrite"), 0);
  expectPlain(shell("$R info gone_" + quoted), static_cast<int>(ErrorCode::File));
  expectPlain(shell("$R generate " + quoted + " -o " + quoted), static_cast<int>(ErrorCode::Usage));
  expectPlain(shell("$R --gone" + quoted), static_cast<int>(ErrorCode::Usage));
  writeMesh(path(name), torn);  // The query has written its results there.
  const Result info = shell("$R info " + quoted);
  const size_t command = info.out.find("raymap repair ");
  ASSERT_NE(command, std::string::npos) << info.out;
  // The shown command works in bash as it stands.
  std::string line = info.out.substr(command, info.out.find('\n', command) - command);
  EXPECT_EQ(line,
            "raymap repair $'t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\\\\\'.ply' -o "
            "$'t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\\\\\'.solid.ply'");
  expectPlain(shell(line.replace(0, 6, "$R")), 0);
  EXPECT_EQ(fs::exists(path("t\x1b[31m\n\x7f\xc2\x9b\\'.solid.ply")), true);
  // Other characters stay as they are.
  fs::rename(path(name), path("t\xc3\xa9 \xe2\x82\xac \xff.ply"));
  EXPECT_NE(
      shell("$R generate $'t\\xc3\\xa9 \\xe2\\x82\\xac \\xff.ply' -o f.nrrd --resolution 8 --device cpu")
          .out.find("t\xc3\xa9 \xe2\x82\xac \xff.ply: "),
      std::string::npos);
}

TEST_F(Cli, FailsWhereItsTextIsLost) {
  for (const char* arguments : {"--version", "--help", "repair --help"}) {
    const Result result = shell(std::string("$R ") + arguments + " >/dev/full");
    EXPECT_EQ(result.code, static_cast<int>(ErrorCode::File)) << arguments;
    EXPECT_EQ(result.err, "raymap: error: standard output: cannot write the text: No space left on device\n");
  }
}

TEST_F(Cli, ShowsOptionsAsTheyAreWritten) {
  for (const char* command : {"generate", "info", "query", "mesh", "render", "repair", "compare", "convert",
                              "example", "devices"}) {
    const std::string help = succeed(std::string(command) + " --help").out;
    for (const char* oddity : {"{false}", "{true}", "[0]", "(=1024b)", "INT in ["})
      EXPECT_EQ(help.find(oddity), std::string::npos) << help;
  }
  EXPECT_NE(succeed("repair --help").out.find("--no-close-holes "), std::string::npos);
}

TEST_F(Cli, ShowsLengthsThatAreShort) {
  writeTorus();
  expectFailure("repair torus.ply -o s.stl --voxel-size 0.25 --shell 1e-9", ErrorCode::Usage,
                "a wall of 1e-09 is thinner than two samples (0.5)");
  expectFailure("generate torus.ply -o f.nrrd --voxel-size 1e-12", ErrorCode::Usage,
                "at a spacing of 1e-12 needs");
  expectFailure("render torus.ply -o f.png --up 0 1e-320 0", ErrorCode::Usage, "--direction and --up");
}

TEST_F(Cli, DrawsFilesOfPrintersAndCadWithZUp) {
  writeTorus();
  succeed("convert torus.ply torus.stl");
  const std::string small = " --size 32 24 --resolution 24 -o ";
  const auto drawn = [&](const std::string& arguments) {
    succeed(arguments + " p.png");
    return readBytes(path("p.png"));
  };
  const std::string zUp = drawn("render torus.ply --up 0 0 1 --direction -0.6 1 -0.45" + small);
  const std::string yUp = drawn("render torus.ply --up 0 1 0 --direction -0.6 -0.45 -1" + small);
  EXPECT_NE(zUp, yUp);
  EXPECT_EQ(drawn("render torus.ply" + small), yUp);
  EXPECT_EQ(drawn("render torus.ply --up 0 0 1" + small), zUp);
  EXPECT_EQ(drawn("render torus.stl" + small), zUp);
  EXPECT_EQ(drawn("render torus.stl --up 0 1 0" + small), yUp);
  EXPECT_EQ(shell("$R render - --format stl < torus.stl 2>.text" + small + "-").out, zUp);
  EXPECT_EQ(shell("$R render - --format ply < torus.ply 2>.text" + small + "-").out, yUp);

  EXPECT_EQ(drawn("info torus.stl --size 32 24 --picture"),
            drawn("info torus.ply --size 32 24 --up 0 0 1 --picture"));
  EXPECT_NE(drawn("info torus.stl --size 32 24 --picture"), drawn("info torus.ply --size 32 24 --picture"));
  succeed("generate torus.stl -o f.nrrd --resolution 8 --report-picture r.png");
  EXPECT_EQ(readBytes(path("r.png")), drawn("info torus.ply --up 0 0 1 --picture"));
}

TEST_F(Cli, KeepsAllArraysInOneFile) {
  writeTorus();
  for (const char* extension : {".npz", ".vti", ".vdb"}) {
    if (!hasFieldFormat(extension)) continue;
    SCOPED_TRACE(extension);
    succeed(std::string("generate torus.ply --resolution 16 -o f") + extension +
            " --winding w.nrrd --confidence c.nrrd --triangle-ids t.nrrd");
    const Field all = readField(path(std::string("f") + extension));
    EXPECT_TRUE(std::ranges::equal(all.winding, readField(path("w.nrrd")).winding));
    EXPECT_TRUE(std::ranges::equal(all.confidence, readField(path("c.nrrd")).confidence));
    EXPECT_TRUE(std::ranges::equal(all.triangle, readField(path("t.nrrd")).triangle));
    EXPECT_EQ(all.distance.size(), all.winding.size());
    succeed(std::string("convert f") + extension + " g.npz");
    EXPECT_TRUE(std::ranges::equal(readField(path("g.npz")).triangle, all.triangle));
    succeed(std::string("compare f") + extension + " g.npz --as triangle");
  }
}

TEST_F(Cli, LeavesOutCrossingPairsOnRequest) {
  writeMesh(path("two.ply"), shapes::joined(shapes::torus(2.0, 0.7, 40, 24), shapes::sphere(1.5, 3)));
  EXPECT_NE(succeed("info two.ply --fast").out.find("\ncrossing pairs of faces  not counted (--fast)\n"),
            std::string::npos);
  Json fast = Json::parse(succeed("info two.ply --fast --json").out);
  Json full = Json::parse(succeed("info two.ply --json").out);
  EXPECT_EQ(fast["self_intersections"], Json({{"counted", false}}));
  EXPECT_GT(full["self_intersections"]["pairs"], 100);
  EXPECT_FALSE(full["self_intersections"].contains("counted"));
  EXPECT_EQ(fast["verdict"]["kind"], "several_solids");
  EXPECT_EQ(full["verdict"]["kind"], "overlapping_solids");
  for (const char* key : {"self_intersections", "verdict"}) {
    fast.erase(key);
    full.erase(key);
  }
  EXPECT_EQ(fast, full);
  expectFailure("info two.ply --fast --picture two.png", ErrorCode::Usage, "leave out --fast");
}

TEST_F(Cli, EndsInformationWithAVerdict) {
  const auto verdict = [&](const Mesh& mesh, const std::string& arguments) {
    writeMesh(path("a mesh.ply"), mesh);
    const std::string text = succeed("info 'a mesh.ply'" + arguments).out;
    return text.substr(text.find("\n\n") + 2);
  };
  const Mesh torus = shapes::torus(2.0, 0.7, 40, 24), ball = shapes::sphere(1.5, 3);
  const Mesh two = shapes::joined(torus, ball);
  const std::string pairs = std::to_string(findSelfIntersections(two).pairs);
  EXPECT_EQ(
      verdict(torus, ""),
      "This is a clean solid, with nothing wrong.\nNo part is thinner than 0.216; a repair with 256 samples "
      "keeps all.\n");
  EXPECT_EQ(verdict(two, ""),
            "This is 2 closed parts that overlap: " + pairs +
                " pairs of faces cross.\nTo make it a clean solid: raymap repair "
                "'a mesh.ply' -o 'a mesh.solid.ply'\nNo part is thinner than 0.216; a repair "
                "with 256 samples keeps all.\n");
  const auto slab = [&](double depth) { return verdict(shapes::box({0, 0, 0}, {10, 10, depth}), ""); };
  EXPECT_EQ(slab(0.2),
            "This is a clean solid, with nothing wrong.\nIts thinnest part is about 0.2 thick. A repair "
            "with 256 samples keeps it; so does --voxel-size 0.1.\n");
  EXPECT_EQ(slab(0.03),
            "This is a clean solid, with nothing wrong.\nIts thinnest part is about 0.03 thick. To keep "
            "it takes --voxel-size 0.015: 800 x 800 x 136 samples.\n");
  EXPECT_EQ(slab(0.001),
            "This is a clean solid, with nothing wrong.\nIts thinnest part is about 0.001 thick. To "
            "keep it would take --voxel-size 0.0005: 24,000 x 24,000 x 4,003 samples, which is too many; 256 "
            "samples "
            "keep parts from 0.0938 on.\n");
  EXPECT_EQ(verdict(two, " --fast"),
            "This is 2 clean, separate solids, with nothing wrong. Faces that cross were not counted "
            "(--fast).\n");
  Mesh torn = torus;
  torn.triangles.pop_back();
  std::swap(torn.triangles[9].x, torn.triangles[9].y);
  EXPECT_TRUE(verdict(torn, "").starts_with(
      "This is a solid with holes, as scans have: 1 hole, 0.507 wide. It also has "))
      << verdict(torn, "");
  EXPECT_NE(verdict(torn, "").find("It also has 1 turned face.\n"), std::string::npos);
  Mesh square;
  square.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::string sheet = verdict(square, "");
  const size_t command = sheet.find("raymap mesh ");
  ASSERT_NE(command, std::string::npos) << sheet;
  EXPECT_EQ(sheet.substr(command),
            "raymap mesh 'a mesh.ply' -o 'a mesh.solid.ply' --thickness 0.2 --voxel-size 0.05\n");
  succeed(sheet.substr(command + 7, sheet.size() - command - 8) + " --device cpu");
  EXPECT_NEAR(diagnose(readMesh(path("a mesh.solid.ply"))).signedVolume, 20.0, 2.0);
}

TEST_F(Cli, SamplesCurvesAsAsked) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).x > 2.2; });
  writeMesh(path("torn.ply"), mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  std::ofstream(path("points.txt")) << "# in samples\n 3 -2 1\n\n-100\t0 4   # far away\r\n";
  Options options{.orientation = Orientation::Keep, .winding = true, .device = "cpu"};
  const auto expectSame = [&](const std::string& arguments) {
    succeed(
        "generate torn.ply -o f.npy --winding w.npy --resolution 24 --device cpu --orientation keep --stats "
        "s.json " +
        arguments);
    const Field expected = generate(mesh, grid, options).field;
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
  options.sampling = Sampling::Raymap;
  expectSame("--sign evolution --passes 3 --offsets points.txt");
}

TEST_F(Cli, NamesTheLineOfABadOffset) {
  writeTorus();
  const auto refuse = [&](const std::string& lines, ErrorCode code, const std::string& message) {
    std::ofstream(path("points.txt")) << lines;
    expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets points.txt", code, message);
  };
  refuse("1 2 3\n\n4 5\n", ErrorCode::Input, "points.txt:3: 2 numbers; a line holds an offset x y z");
  refuse("1 2 3 4\n", ErrorCode::Input, "points.txt:1: 4 numbers");
  refuse("1 2 3\n1 0.5 2\n", ErrorCode::Input, "points.txt:2: '0.5' is no such number");
  refuse("1 2 3000000000\n", ErrorCode::Input, "points.txt:1: '3000000000' is no such number");
  refuse("1, 2, 3\n", ErrorCode::Input, "points.txt:1: '1,'");
  refuse("# nothing\n", ErrorCode::Input, "points.txt: it holds no offsets");
  expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets no.txt", ErrorCode::File,
                "no.txt: cannot be opened");
  expectFailure("generate torus.ply -o f.nrrd --sign paths --offsets .", ErrorCode::File, "cannot be opened");
  for (const char* extra : {"--offsets points.txt", "--sampling paper", "--sign rays --sampling paper"})
    expectFailure(std::string("generate torus.ply -o f.nrrd ") + extra, ErrorCode::Usage,
                  "--sampling and --offsets need --sign paths or evolution");
  EXPECT_FALSE(fs::exists(path("f.nrrd")));
}

TEST_F(Cli, CoversTheRequestedBox) {
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

TEST_F(Cli, ConvertsAndCompares) {
  writeTorus();
  succeed("generate torus.ply -o a.nrrd --resolution 24");
  for (const char* name : {"b.npz", "b.vti", "b.vdb", "b.nrrd"}) {
    succeed(std::string("convert a.nrrd ") + name);
    const Json found = Json::parse(succeed(std::string("compare a.nrrd --json ") + name).out);
    EXPECT_EQ(found["max"], 0.0) << name;
    EXPECT_EQ(found["sign_differences"], 0) << name;
  }
  succeed("generate torus.ply -o c.nrrd --resolution 24 --winding w.nrrd");
  succeed("convert w.nrrd w.npz");
  EXPECT_GT(readField(path("w.npz")).winding.size(), 0u);
  succeed("generate torus.ply -o inverted.nrrd --resolution 24 --invert");
  const Json found = Json::parse(succeed("compare a.nrrd inverted.nrrd --json -o difference.png").out);
  EXPECT_EQ(found["sign_differences"], found["samples"]);
  EXPECT_TRUE(fs::exists(path("difference.png")));
  Field broken = readField(path("a.nrrd"));
  broken.distance[5] = std::numeric_limits<float>::quiet_NaN();
  writeField(path("broken.nrrd"), broken);
  EXPECT_EQ(Json::parse(succeed("compare a.nrrd broken.nrrd --json").out)["non_finite"], 1);
  EXPECT_NE(succeed("compare a.nrrd broken.nrrd").out.find("not finite        1,"), std::string::npos);
}

TEST_F(Cli, ConvertsMeshes) {
  writeTorus();
  succeed("convert torus.ply torus.glb");
  const Mesh before = readMesh(path("torus.ply")), after = readMesh(path("torus.glb"));
  EXPECT_EQ(before.vertices, after.vertices);
  EXPECT_EQ(before.triangles, after.triangles);
  expectFailure("convert torus.ply torus.vdb", ErrorCode::Usage, "torus.vdb");
}

TEST_F(Cli, ConvertsUnitsScaleAndAxis) {
  // y is up: 2 wide, 3 high, 5 deep.
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(2, 3, 5)));
  const auto boxOf = [&](const char* name) { return bounds(readMesh(path(name))); };
  const auto expectBox = [&](const char* name, const glm::dvec3& low, const glm::dvec3& high) {
    const Box box = boxOf(name);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(box.min[axis], low[axis], 1e-4) << name << " " << axis;
      EXPECT_NEAR(box.max[axis], high[axis], 1e-4) << name << " " << axis;
    }
    EXPECT_GT(diagnose(readMesh(path(name))).signedVolume, 0.0) << name;
  };
  succeed("convert box.ply a.3mf");
  expectBox("a.3mf", {0, 0, 0}, {2, 3, 5});
  succeed("convert box.ply inch.3mf --unit in");
  expectBox("inch.3mf", {0, 0, 0}, {50.8, 76.2, 127});
  succeed("convert box.ply scaled.ply --scale 2.5 --unit in");
  expectBox("scaled.ply", {0, 0, 0}, {5, 7.5, 12.5});
  succeed("convert box.ply z.ply --up y");
  expectBox("z.ply", {0, -5, 0}, {2, 0, 3});
  succeed("convert z.ply same.ply --up z");
  expectBox("same.ply", {0, -5, 0}, {2, 0, 3});
  succeed("convert z.ply y.glb --up z --unit m");
  expectBox("y.glb", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb y2.glb --up y");
  expectBox("y2.glb", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb metres.3mf --scale .001");
  expectBox("metres.3mf", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb b.stl --unit cm --scale 2 --up y");
  expectBox("b.stl", {0, -1000, 0}, {400, 0, 600});
  EXPECT_EQ(
      run("convert y.glb c.stl").err,
      "raymap: warning: c.stl: its lengths are in m, as in y.glb, but programs take them for mm; --unit mm "
      "converts them\n");
  expectBox("c.stl", {0, 0, 0}, {2, 3, 5});
  EXPECT_EQ(
      run("convert a.3mf c.glb").err,
      "raymap: warning: c.glb: its lengths are in mm, as in a.3mf, but programs take them for m; --unit m "
      "converts them\n");
}

TEST_F(Cli, RefusesUnitsThatMeanNothing) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)));
  expectFailure("convert box.ply a.3mf --unit furlong", ErrorCode::Usage,
                "--unit: furlong not in {um,mm,cm,m,in,ft}");
  expectFailure("convert box.ply a.3mf --up x", ErrorCode::Usage, "--up: x not in {y,z}");
  expectFailure("convert box.ply a.3mf --scale 0", ErrorCode::Usage,
                "--scale: must be a number above 0, not 0");
  expectFailure("convert box.ply a.3mf --scale 1e39", ErrorCode::Usage,
                "--scale 1e+39: the mesh becomes too large for single precision");
  expectFailure("convert box.ply a.3mf --scale 1e-39", ErrorCode::Usage,
                "--scale 1e-39: the mesh becomes too small for single precision");
  expectFailure("repair box.ply -o a.glb --unit mm", ErrorCode::Usage,
                "--unit mm: a.glb is in metres, as its format demands; use --unit m");
  Field field;
  field.grid = {{2, 2, 2}, glm::dvec3(0.0), 1.0};
  field.distance.resizeUninitialized(8);
  std::ranges::fill(field.distance, 1.0F);
  writeField(path("field.nrrd"), field);
  expectFailure("convert field.nrrd a.npz --scale 2", ErrorCode::Usage,
                "--unit, --scale, --up and --recenter are for meshes, and field.nrrd is a field");
  expectFailure("convert field.nrrd a.npz --recenter", ErrorCode::Usage, "are for meshes");
  EXPECT_EQ(fileCount(), 2u);
}

TEST_F(Cli, TellsTheUnit) {
  writeMesh(path("box.3mf"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)), {.unit = LengthUnit::Inch});
  const Result inch = run("info box.3mf");
  EXPECT_NE(inch.out.find("unit                     mm\n"), std::string::npos) << inch.out;
  EXPECT_EQ(inch.err,
            "raymap: warning: box.3mf: 3D/3dmodel.model is in the unit inch; converted to millimetres\n");
  EXPECT_EQ(Json::parse(run("info box.3mf --json").out)["unit"], "mm");
}

TEST_F(Cli, RepairsInUnitsAndAxes) {
  writeMesh(path("ball.glb"), shapes::sphere(1.0, 4));
  succeed("repair ball.glb -o ball.3mf --unit mm --up y --resolution 20 --stats s.json");
  EXPECT_NEAR(bounds(readMesh(path("ball.3mf"))).max.z, 1000, 10);
  const Json options = json("s.json")["options"];
  EXPECT_EQ(options["unit"], "mm");
  EXPECT_EQ(options["scale"], 1.0);
  EXPECT_EQ(options["up"], "y");
  succeed("repair ball.glb -o plain.glb --resolution 20 --stats t.json");
  EXPECT_EQ(json("t.json")["options"]["unit"], "m");
  EXPECT_TRUE(json("t.json")["options"]["up"].is_null());
}

TEST_F(Cli, DrillsDownInTheAxesOfTheResult) {
  writeMesh(path("ball.ply"), shapes::sphere(1.0, 4));
  const auto drilled = [&](const std::string& output, const std::string& options) {
    succeed("repair ball.ply -o " + output + " --resolution 40 --shell .15 --drain-hole .25 " + options);
    return readBytes(path(output));
  };
  const std::string glb = drilled("a.glb", "--up y");
  EXPECT_EQ(glb, drilled("b.glb", "--up y --down 0 -1 0"));
  EXPECT_NE(glb, drilled("c.glb", "--up y --down 0 0 -1"));
  EXPECT_EQ(drilled("a.ply", "--up z"), drilled("b.ply", "--down 0 0 -1"));
  EXPECT_EQ(drilled("c.glb", "--down 0 0 -1"), drilled("d.glb", ""));
}

TEST_F(Cli, DrawsPictures) {
  writeTorus();
  succeed("generate torus.ply -o torus.nrrd --resolution 24");
  succeed("render torus.nrrd -o picture.png --size 64 48");
  const std::string png = readBytes(path("picture.png"));
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x40\0\0\0\x30", 8));  // IHDR: width, height.
  succeed("render torus.nrrd -o cut.png --size 64 48 --cut --shell 0.2");
  EXPECT_NE(readBytes(path("cut.png")), png);
  succeed("render torus.ply -o direct.png --resolution 24 --size 64 48");
  EXPECT_EQ(readBytes(path("direct.png")), png);
  expectFailure("render torus.nrrd -o gpu.png --device gpu", ErrorCode::Usage, "'gpu'");
  expectFailure("render torus.nrrd -o gpu.png --device vulkan:99", ErrorCode::Unsupported, "vulkan:99");
  EXPECT_FALSE(fs::exists(path("gpu.png")));
  const Result slice = succeed("render torus.nrrd -o slice.png --slice z --index 3");
  EXPECT_EQ(slice.out.rfind("wrote slice.png, ", 0), 0u) << slice.out;
  expectFailure("render torus.nrrd -o slice.png --slice z --index 99", ErrorCode::Usage, "across z");
  EXPECT_TRUE(fs::exists(path("slice.png")));
}

// Winding numbers, confidences and triangles, in files that name what they hold and in those that do not.
TEST_F(Cli, DrawsAndComparesTheOtherArrays) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).x > 2.2; });
  writeMesh(path("torn.ply"), mesh);
  const auto make = [&](const std::string& stem, const std::string& extension, const std::string& more) {
    succeed("generate torn.ply --resolution 24 --device cpu -o " + stem + ".nrrd --winding " + stem + "w" +
            extension + " --confidence " + stem + "c" + extension + " --triangle-ids " + stem + "t" +
            extension + more);
  };
  std::map<std::string, std::string> pictures;
  for (const std::string extension : {".nrrd", ".vti", ".npz", ".npy", ".vdb"}) {
    if (!hasFieldFormat(extension)) continue;
    make("a", extension, "");
    for (const auto& [letter, array] : {std::pair("w", "winding"), {"c", "confidence"}, {"t", "triangle"}}) {
      const std::string file = "a" + std::string(letter) + extension;
      const bool isNamed = extension != ".npy" || array == std::string("triangle");
      const std::string as = isNamed ? "" : std::string(" --as ") + array;
      succeed("render " + file + " -o slice.png --slice z --size 96 72" + as);
      const std::string picture = readBytes(path("slice.png"));
      if (pictures.contains(letter)) {
        EXPECT_EQ(picture, pictures[letter]) << file;
      }
      pictures[letter] = picture;
      if (isNamed)
        expectFailure("render " + file + " -o solid.png", ErrorCode::Usage,
                      file + ": the array '" + array + "' has no surface to draw; draw a slice of it");
      const Json same = Json::parse(succeed("compare " + file + " " + file + " --json" + as).out);
      EXPECT_EQ(same["array"], array);
      EXPECT_EQ(same[array == std::string("triangle") ? "differences" : "max"], 0);
      EXPECT_FALSE(same.contains("sign_differences"));
    }
  }
  EXPECT_NE(pictures["w"], pictures["c"]);
  EXPECT_NE(pictures["w"], pictures["t"]);
  // From the mesh itself.
  succeed("render torn.ply --resolution 24 --device cpu -o slice.png --slice z --size 96 72 --as winding");
  EXPECT_EQ(readBytes(path("slice.png")), pictures["w"]);

  make("b", ".nrrd", " --sign rays --distance cell");
  make("a", ".nrrd", "");
  const Field a = readField(path("aw.nrrd")), b = readField(path("bw.nrrd"));
  const Json found = Json::parse(succeed("compare aw.nrrd bw.nrrd --json -o difference.png").out);
  EXPECT_EQ(found["max"], compareFields(a, b, FieldArray::Winding).maxError);
  EXPECT_GT(found["max"], 0.1);
  EXPECT_TRUE(fs::exists(path("difference.png")));
  const std::string text = succeed("compare at.nrrd bt.nrrd").out;
  const Comparison ids =
      compareFields(readField(path("at.nrrd")), readField(path("bt.nrrd")), FieldArray::Triangle);
  char share[32];
  std::snprintf(share, sizeof share, ", %.4g %%\n", 100.0 * double(ids.differences) / double(ids.samples));
  EXPECT_NE(text.find("\ndifferences       "), std::string::npos) << text;
  EXPECT_NE(text.find(share), std::string::npos) << text << share;
  EXPECT_EQ(Json::parse(succeed("compare at.nrrd bt.nrrd --json").out)["differences"], ids.differences);
  EXPECT_EQ(text.find("largest"), std::string::npos) << text;
  EXPECT_NE(succeed("compare aw.nrrd bw.nrrd").out.find("mean              0."), std::string::npos);

  expectFailure("compare aw.nrrd at.nrrd", ErrorCode::Usage,
                "aw.nrrd holds the array 'winding', at.nrrd the array 'triangle'");
  expectFailure("compare aw.nrrd bw.nrrd --as triangle", ErrorCode::Usage,
                "aw.nrrd: it holds the array 'winding', not 'triangle'; leave out --as");
  expectFailure("render aw.nrrd -o f.png --slice z --as distance", ErrorCode::Usage, "leave out --as");
  expectFailure("render a.nrrd -o f.png --slice z --as colour", ErrorCode::Usage, "--as");
  expectFailure("mesh aw.nrrd -o f.ply", ErrorCode::Usage, "it has no distances");
  EXPECT_FALSE(fs::exists(path("f.png")));
}

TEST_F(Cli, MakesAClosedMesh) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  mesh.triangles.pop_back();
  writeMesh(path("torn.ply"), mesh);
  succeed("generate torn.ply -o torn.vdb --resolution 40");
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb", "a.3mf"}) {
    const std::string text = succeed(std::string("mesh torn.vdb -o ") + name).out;
    EXPECT_NE(text.find(std::string("wrote ") + name), std::string::npos) << text;
    const Diagnostics found = diagnose(readMesh(path(name)));
    EXPECT_TRUE(found.watertight && found.consistentlyOriented) << name;
    EXPECT_NEAR(found.signedVolume, 19.1, 0.3) << name;
  }
  succeed("mesh torn.ply -o direct.ply --resolution 40");
  EXPECT_EQ(readBytes(path("direct.ply")), readBytes(path("a.ply")));
  succeed("mesh torn.vdb -o grown.ply --iso 0.2");
  EXPECT_GT(diagnose(readMesh(path("grown.ply"))).signedVolume, 25.0);
  const Result cut = run("mesh torn.ply -o cut.ply --voxel-size 0.1 --bounds -4 -4 -1 0 4 1");
  EXPECT_EQ(cut.code, 0);
  EXPECT_NE(cut.err.find("closed there"), std::string::npos) << cut.err;
  EXPECT_NEAR(diagnose(readMesh(path("cut.ply"))).signedVolume, 9.5, 0.3);
  expectFailure("mesh torn.vdb -o a.fbx", ErrorCode::Usage,
                "--output a.fbx: the name must end in one of .ply");
  expectFailure("mesh torn.vdb -o b.ply --iso -9", ErrorCode::Usage, "no surface at -9");
  EXPECT_FALSE(fs::exists(path("b.ply")));
}

TEST_F(Cli, ThickensSheets) {
  writeMesh(path("square.ply"), makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}},
                                         {{0, 1, 2}, {0, 2, 3}}));
  succeed("mesh square.ply -o plate.stl --thickness 0.4 --voxel-size 0.1");
  const Diagnostics found = diagnose(readMesh(path("plate.stl")));
  EXPECT_TRUE(found.watertight);
  // The volume of a plate, of half cylinders at its sides and of a ball at its corners.
  EXPECT_NEAR(found.signedVolume, 4.0 * 4.0 * 0.4 + 8.0 * 0.1257 / 2.0 * 2.0 + 0.0335, 0.1);
  succeed("generate square.ply -o plate.nrrd --thickness 0.4 --voxel-size 0.1 --stats plate.json");
  EXPECT_EQ(json("plate.json")["options"]["thickness"], 0.4);
  succeed("render square.ply -o plate.png --thickness 0.4 --resolution 32 --size 64 48");
  expectFailure("generate square.ply -o f.nrrd --thickness 0.4 --sign rays", ErrorCode::Usage,
                "place of --sign");
  expectFailure("generate square.ply -o f.nrrd --thickness 0.4 --close-holes", ErrorCode::Usage,
                "needs a sign");
}

TEST_F(Cli, RepairsAMesh) {
  Mesh mesh = shapes::torus(2.0, 0.7, 60, 40);
  mesh.triangles.pop_back();
  writeMesh(path("torn.ply"), mesh);
  const std::string text =
      succeed("repair torn.ply -o solid.stl --remesh --resolution 64 --stats solid.json").out;
  EXPECT_NE(text.find("wrong with it: 3 boundary edges"), std::string::npos) << text;
  EXPECT_NE(text.find("watertight"), std::string::npos) << text;
  const Json solid = json("solid.json");
  const double spacing = solid["grid"]["spacing"];
  EXPECT_TRUE(solid["after"]["watertight"]);
  EXPECT_LT(solid["result_from_mesh"]["max"], 0.5 * spacing);
  EXPECT_LT(solid["mesh_from_result"]["max"], 0.5 * spacing);
  EXPECT_GT(solid["result_from_mesh"]["points"], 10000);
  EXPECT_EQ(solid["after"]["self_intersections"]["pairs"], 0);
  EXPECT_NE(text.find("0 pairs before, 0 pairs after"), std::string::npos) << text;
  EXPECT_GT(solid["patch"]["triangles"], 0);
  succeed("repair torn.ply -o grown.ply --resolution 64 --offset 0.15 --stats grown.json");
  const double ratio = json("grown.json")["after"]["signed_volume"].get<double>() /
                       solid["after"]["signed_volume"].get<double>();
  EXPECT_NEAR(ratio, 0.85 * 0.85 / 0.49, 0.01);
  EXPECT_LT(json("grown.json")["result_from_mesh"]["p99"], 0.2 * spacing);
  expectFailure("repair torn.ply -o none.ply --resolution 64 --offset -1", ErrorCode::Input,
                "bounds nothing");
  const std::string filled = succeed("repair torn.ply -o filled.ply --stats filled.json").out;
  EXPECT_NE(filled.find("\nclosed 1 hole with 1 face, all other faces kept as they are"), std::string::npos)
      << filled;
  EXPECT_EQ(json("filled.json")["closed_holes"], 1);
  EXPECT_EQ(json("filled.json")["closing_faces"], 1);
  EXPECT_EQ(json("filled.json")["after"]["triangles"], 4800);
}

TEST_F(Cli, RefusesAFormatThatBreaksTheResult) {
  writeMesh(path("far.obj"), shapes::box({5e5, 5.5e6, 300.0}, {5e5 + 10.0, 5.5e6 + 8.0, 306.0}));
  for (const char* command : {"repair", "mesh"}) {
    const std::string run = std::string(command) + " far.obj --overwrite --resolution 64 " +
                            (std::string(command) == "repair" ? "--remesh --tolerance 0 " : "") + "-o far";
    expectFailure(run + ".stl", ErrorCode::Unsupported,
                  "write a .ply, .obj, .glb or .3mf, or add --recenter");
    EXPECT_FALSE(fs::exists(path("far.stl")));
    const std::string text = succeed(run + ".stl --recenter").out;
    EXPECT_NE(text.find("recentered: add 500005 5500004 303 to the positions"), std::string::npos) << text;
    const Diagnostics found = diagnose(readMesh(path("far.stl")));
    EXPECT_TRUE(found.watertight);
    EXPECT_EQ(found.degenerateFaces, 0);
    EXPECT_NEAR(found.signedVolume, 480.0, 1.0);
    EXPECT_NEAR(found.bounds.min.y, -4.0, 0.01);
    fs::remove(path("far.stl"));
    for (const char* format : {".ply", ".obj", ".glb"}) {
      EXPECT_EQ(succeed(run + format).out.find("recentered"), std::string::npos);
      const Diagnostics kept = diagnose(readMesh(path(std::string("far") + format)));
      EXPECT_TRUE(kept.watertight);
      EXPECT_NEAR(kept.bounds.min.y, 5.5e6, 0.01);
    }
  }
  succeed("repair far.obj --resolution 64 --remesh -o far.ply --recenter --stats far.json");
  EXPECT_EQ(json("far.json")["file_offset"], Json({500005.0, 5500004.0, 303.0}));
  EXPECT_LT(json("far.json")["mesh_from_result"]["max"], 0.02);
}

TEST_F(Cli, WarnsThatAFormatMovesTheMesh) {
  Mesh ball = shapes::sphere(10.0, 3);
  ball.origin = {5e6, 4e6, 100.0};
  writeMesh(path("far.ply"), ball);
  for (const std::string command :
       {"convert far.ply ", "repair far.ply -o ", "mesh far.ply --resolution 32 -o "}) {
    const Result moved = run(command + "far.stl --overwrite");
    EXPECT_EQ(moved.code, 0) << moved.err;
    EXPECT_TRUE(std::regex_search(
        moved.err,
        std::regex("^raymap: warning: far.stl: so far from \\(0, 0, 0\\), the single precision of this "
                   "format moves vertices by up to 0.2[5-9][0-9]*, 1.[2-4][0-9]* % of the mesh's size; "
                   "write one of .ply .obj .glb .3mf, or move the mesh closer by --recenter\n$")))
        << moved.err;
    const std::string text = succeed(command + "near.stl --recenter --overwrite").out;
    EXPECT_NE(text.find("recentered: add 5e+06 4e+06 100 to the positions"), std::string::npos) << text;
    EXPECT_LT(glm::length(bounds(readMesh(path("near.stl"))).centre()), 0.1);
  }
}

TEST_F(Cli, MeasuresTheMeshAsStored) {
  // Steps of 2^-6 are small enough to keep the box whole, but larger than the result's other deviations.
  writeMesh(path("far.obj"), shapes::box({2e5, 0.0, 0.0}, {2e5 + 10.003, 8.0, 6.0}));
  const auto deviation = [&](const std::string& file) {
    EXPECT_EQ(run("repair far.obj --resolution 64 --remesh --tolerance 0 --stats s.json -o " + file).code, 0);
    return json("s.json")["result_from_mesh"]["mean"].get<double>();
  };
  EXPECT_GT(deviation("far.stl"), 2.0 * deviation("far.ply"));
  EXPECT_LT(deviation("far.stl --recenter"), 1.01 * deviation("far.ply"));
}

TEST_F(Cli, LeavesHolesAndFacesAsTheyAreOnRequest) {
  Mesh mesh = shapes::torus(2.0, 0.7, 60, 40);
  for (size_t f = 0; f < mesh.triangles.size(); f += 5) turnFaces(mesh, std::vector<uint32_t>{uint32_t(f)});
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.65; });
  writeMesh(path("torn.ply"), mesh);
  succeed("repair torn.ply -o turned.stl --resolution 48 --stats turned.json");
  const Json turned = json("turned.json");
  EXPECT_GT(turned["turned_faces"], mesh.triangles.size() / 6);
  EXPECT_GT(turned["patch"]["triangles"], 0);
  succeed(
      "repair torn.ply -o kept.stl --resolution 48 --orientation keep --no-close-holes --stats kept.json");
  const Json kept = json("kept.json");
  EXPECT_EQ(kept["turned_faces"], 0);
  EXPECT_EQ(kept["patch"]["triangles"], 0);
  EXPECT_TRUE(kept["after"]["watertight"]);
}

TEST_F(Cli, MakesASolidOfADoubleSidedMesh) {
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
  EXPECT_NE(text.find("bound a solid; 5,120 other sides left out\n"), std::string::npos) << text;
  EXPECT_EQ(json("s.json")["left_out_faces"], faces);
  EXPECT_EQ(json("s.json")["orientation_fits"], true);
  EXPECT_EQ(json("r.json")["orientation"]["left_out_faces"], faces);
  EXPECT_EQ(json("r.json")["orientation"]["fits"], true);
  EXPECT_LT(least(path("ball.nrrd")), -0.95f);
  succeed("generate ball.ply -o kept.nrrd --resolution 48 --device cpu --orientation keep --stats s.json");
  EXPECT_EQ(json("s.json")["left_out_faces"], 0);
  EXPECT_GT(least(path("kept.nrrd")), 0.0f);
  const std::string repaired = succeed("repair ball.ply -o solid.stl --resolution 64 --stats solid.json").out;
  EXPECT_NE(repaired.find("5,120 other sides left out"), std::string::npos) << repaired;
  const Json solid = json("solid.json");
  EXPECT_EQ(solid["left_out_faces"], faces);
  EXPECT_EQ(solid["orientation_fits"], true);
  EXPECT_TRUE(solid["after"]["watertight"]);
  EXPECT_NEAR(solid["after"]["signed_volume"], 4.18879, 0.04);
}

TEST_F(Cli, SaysThatNoOrientationFits) {
  Mesh fan = shapes::sphere(1.0, 5);  // All faces meet in the centre.
  fan.vertices.emplace_back(0.0f);
  for (glm::uvec3& t : fan.triangles) t.z = uint32_t(fan.vertices.size() - 1);
  writeMesh(path("fan.ply"), withFlippedFaces(fan, 0.5, 5));
  const std::string text =
      succeed("generate fan.ply -o fan.nrrd --resolution 40 --device cpu --stats s.json").out;
  EXPECT_NE(text.find("orientation: no directions of the faces fit the crossings, misfit "),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("; the faces are used as given\n"), std::string::npos) << text;
  EXPECT_EQ(json("s.json")["orientation_fits"], false);
  EXPECT_EQ(json("s.json")["turned_faces"], 0);
  EXPECT_GT(json("s.json")["misfit"], 0.5);
}

TEST_F(Cli, HollowsAMeshOut) {
  writeMesh(path("ball.ply"), shapes::sphere(1.0, 4));
  succeed("repair ball.ply -o ball.stl --resolution 64 --shell 0.2 --stats ball.json");
  const Json ball = json("ball.json");
  EXPECT_EQ(ball["hollows"], 1);
  EXPECT_EQ(ball["after"]["components"], 2);
  EXPECT_NEAR(ball["after"]["signed_volume"], 4.18879 * (1.0 - 0.512), 0.02);
  succeed("repair ball.ply -o drained.stl --resolution 64 --shell 0.2 --drain-hole 0.3 --stats drained.json");
  const Json drained = json("drained.json");
  EXPECT_EQ(drained["drain_holes"], 1);
  EXPECT_EQ(drained["after"]["components"], 1);
  EXPECT_TRUE(drained["after"]["watertight"]);
  // A sphere in a sphere becomes one surface: the drain runs straight down from the middle.
  const Mesh mesh = readMesh(path("drained.stl"));
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::dvec3 p = mesh.position(v);
    EXPECT_TRUE(p.z > -0.7 || std::hypot(p.x, p.y) > 0.1) << p.x << " " << p.y << " " << p.z;
  }
  expectFailure("repair ball.ply -o thin.stl --resolution 64 --shell 0.01", ErrorCode::Usage,
                "thinner than two samples");
  expectFailure("repair ball.ply -o thin.stl --drain-hole 0.3", ErrorCode::Usage,
                "--drain-hole requires --shell");
}

TEST_F(Cli, DrillsVents) {
  writeMesh(path("ball.ply"), shapes::sphere(1.0, 4));
  const std::string repair = "repair ball.ply -o ball.stl --resolution 48 --shell 0.25 --stats ball.json ";
  const std::string text = succeed(repair + "--drain-hole 0.3 --drain-holes 2").out;
  EXPECT_NE(text.find("  1 hollow, 2 drain holes\n  drain hole "), std::string::npos) << text;
  EXPECT_NE(text.find(", direction 0 0 -1\n"), std::string::npos) << text;
  const Json ball = json("ball.json");
  ASSERT_EQ(ball["drain_hole_places"].size(), 2u);
  EXPECT_NEAR(ball["drain_hole_places"][0]["position"][2], -1.0, 0.1);
  EXPECT_NEAR(ball["drain_hole_places"][1]["position"][2], 1.0, 0.1);
  EXPECT_EQ(ball["drain_hole_places"][1]["direction"][2], 1.0);
  EXPECT_EQ(ball["cavities"], 0);
  const Result crowded = run(repair + "--drain-hole 0.7 --drain-holes 9");
  EXPECT_EQ(crowded.code, 0);
  EXPECT_NE(crowded.err.find("of 9 drain holes were made"), std::string::npos) << crowded.err;
  const Result none = run(repair + "--drain-hole 1.7");
  EXPECT_NE(none.err.find("1 hollow is too small for the drain hole"), std::string::npos) << none.err;
  EXPECT_EQ(json("ball.json")["drain_holes"], 0);
  expectFailure(repair + "--drain-hole 0.3 --drain-holes 0", ErrorCode::Usage, "--drain-holes");
  expectFailure(repair + "--drain-holes 2", ErrorCode::Usage, "--drain-holes requires --drain-hole");
}

TEST_F(Cli, ReplacesAnInputOnlyOnRequest) {
  writeTorus();
  const std::string before = readBytes(path("torus.ply"));
  fs::create_symlink("torus.ply", path("link.ply"));
  fs::create_hard_link(path("torus.ply"), path("twin.ply"));
  for (const char* command :
       {"repair torus.ply -o torus.ply", "repair torus.ply -o ./torus.ply", "repair torus.ply -o link.ply",
        "repair link.ply -o torus.ply", "repair torus.ply -o twin.ply", "mesh torus.ply -o torus.ply",
        "convert torus.ply torus.ply", "query torus.ply torus.ply -o link.ply"})
    expectFailure(command, ErrorCode::Usage, "to replace it: --overwrite");
  EXPECT_EQ(readBytes(path("torus.ply")), before);
  succeed("generate torus.ply -o torus.npy --resolution 8 --device cpu");
  expectFailure("convert torus.npy torus.npy", ErrorCode::Usage, "output torus.npy: is the input torus.npy");
  fs::create_hard_link(path("torus.ply"), path("field.nrrd"));
  expectFailure("generate torus.ply -o field.nrrd", ErrorCode::Usage, "to replace it: --overwrite");
  succeed("generate torus.ply -o field.nrrd --resolution 8 --device cpu --overwrite");
  succeed("convert torus.ply torus.ply --overwrite");
  succeed("mesh torus.ply -o torus.ply --resolution 32 --device cpu --overwrite");
  succeed("repair torus.ply -o torus.ply --overwrite");
  succeed("query torus.ply torus.ply -o link.ply --overwrite");
  EXPECT_NE(readBytes(path("torus.ply")), before);
}

TEST_F(Cli, KeepsAMeshThatIsRight) {
  const Mesh ball = shapes::sphere(1.0, 4);
  writeMesh(path("ball.stl"), ball);
  const std::string text = succeed("repair ball.stl -o kept.stl --stats kept.json").out;
  EXPECT_NE(text.find("\nkept as it is, because nothing is wrong with it; to make it anew: --remesh\n"
                      "result: 5,120 triangles, 1 solid, 0 cavities, checked as stored: watertight"),
            std::string::npos)
      << text;
  EXPECT_EQ(readBytes(path("kept.stl")), readBytes(path("ball.stl")));
  EXPECT_EQ(json("kept.json")["kept"], true);
  EXPECT_EQ(json("kept.json")["solids"], 1);
  EXPECT_EQ(json("kept.json")["stages"].at(0).at("name"), "inspect");
  succeed("repair ball.stl -o made.stl --remesh --resolution 32 --stats made.json");
  EXPECT_EQ(json("made.json")["kept"], false);
  EXPECT_NE(json("made.json")["after"]["triangles"], 5120);
  writeMesh(path("two.ply"), shapes::joined(ball, shapes::sphere(0.5, 3)));
  const std::string overlap = succeed("repair two.ply -o one.ply --resolution 32 --stats one.json").out;
  EXPECT_NE(overlap.find("parts of it overlap"), std::string::npos) << overlap;
  EXPECT_EQ(json("one.json")["parts_overlap"], true);
}

TEST_F(Cli, DropsCrumbsAndFillsBubbles) {
  Mesh bubble = shapes::sphere(0.5, 3);
  for (glm::uvec3& t : bubble.triangles) std::swap(t.y, t.z);
  Mesh mesh = shapes::joined(shapes::joined(shapes::sphere(1.0, 4), bubble), shapes::sphere(0.25, 3));
  mesh = shapes::joined(mesh, shapes::sphere(0.08, 2, {1.3, 0, 0}));
  writeMesh(path("ball.ply"), mesh);
  const Result dropped =
      run("repair ball.ply -o ball.stl --remesh --resolution 64 --drop-smaller 0.01 --stats ball.json");
  EXPECT_EQ(dropped.code, 0);
  const Json ball = json("ball.json");
  EXPECT_EQ(ball["solids"], 1);
  EXPECT_EQ(ball["cavities"], 0);
  EXPECT_EQ(ball["drop_smaller"], 0.01);
  EXPECT_EQ(ball["dropped"]["count"], 1);
  EXPECT_NEAR(ball["dropped"]["largest"], 4.18879 * 0.000512, 0.0003);
  EXPECT_NEAR(ball["filled"]["volume"], 4.18879 * 0.125, 0.01);
  EXPECT_NEAR(ball["buried"]["volume"], 4.18879 * 0.015625, 0.005);
  EXPECT_NE(dropped.out.find("1 part, volume 0.002"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.out.find("; below 0.01\n"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.out.find("1 cavity, volume 0.5"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.err.find("warning: filled 1 sealed cavity"), std::string::npos) << dropped.err;
  succeed(
      "repair ball.ply -o all.stl --remesh --resolution 64 --drop-smaller 0 --keep-cavities --stats "
      "all.json");
  EXPECT_EQ(json("all.json")["solids"], 3);
  EXPECT_EQ(json("all.json")["cavities"], 1);
  EXPECT_EQ(json("all.json")["dropped"]["count"], 0);
  expectFailure("repair ball.ply -o none.stl --remesh --resolution 64 --drop-smaller 9", ErrorCode::Input,
                "every part is smaller");
  expectFailure("repair ball.ply -o none.stl --drop-smaller -1", ErrorCode::Usage, "--drop-smaller");
}

TEST_F(Cli, ThickensThinParts) {
  const Mesh fin = shapes::joined(shapes::box({0, 0, 0}, {4, 4, 4}), shapes::box({1, 1.95, 3}, {3, 2.05, 7}));
  writeMesh(path("fin.ply"), fin);
  const std::string text =
      succeed("repair fin.ply -o fin.stl --voxel-size 0.2 --min-thickness 0.5 --stats fin.json").out;
  EXPECT_NE(text.find("of the mesh's area was thinner than 0.5"), std::string::npos) << text;
  const Json stats = json("fin.json");
  EXPECT_EQ(stats["options"]["min_thickness"], 0.5);
  EXPECT_NEAR(stats["thickened_share"].get<double>(), 12.0 / 113.2, 0.01);
  EXPECT_TRUE(stats["after"]["watertight"]);
  EXPECT_NEAR(bounds(readMesh(path("fin.stl"))).max.z, 7.2, 0.1);
  expectFailure("repair fin.ply -o none.stl --voxel-size 0.4 --min-thickness 0.5", ErrorCode::Usage,
                "use a voxel size of at most 0.25");
}

TEST_F(Cli, MakesRoomForThePlateAroundASheet) {
  writeMesh(path("sheet.ply"), makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                        {{0, 1, 2}, {0, 2, 3}}));
  succeed("mesh sheet.ply -o plate.ply --thickness 0.6 --resolution 40");
  EXPECT_NEAR(bounds(readMesh(path("plate.ply"))).size().x, 1.6, 0.03);
  EXPECT_NEAR(bounds(readMesh(path("plate.ply"))).size().z, 0.6, 0.03);
  succeed("generate sheet.ply -o plate.nrrd --thickness 0.6 --resolution 40");
  const Field field = readField(path("plate.nrrd"));
  EXPECT_NEAR(field.grid.spacing, (1.0 + 2.0 * (0.1 + 0.3)) / 40, 1e-9);
  EXPECT_NEAR(field.grid.origin.x, -0.4 + 0.5 * field.grid.spacing, 1e-9);
  EXPECT_LE(field.grid.origin.z, -0.4 + 0.5 * field.grid.spacing + 1e-9);
  EXPECT_GT(field.distance[0], 0.0f);
  succeed("generate sheet.ply -o cut.nrrd --thickness 0.6 --voxel-size 0.1 --bounds 0 0 0 1 1 0.2");
  EXPECT_EQ(readField(path("cut.nrrd")).grid.dims, glm::ivec3(10, 10, 2));
}

TEST_F(Cli, RefusesBadOptions) {
  writeTorus();
  const auto refuse = [&](const std::string& options, const std::string& message) {
    expectFailure("generate torus.ply -o f.nrrd " + options, ErrorCode::Usage, message);
  };
  refuse("--resolution 0", "--resolution: must be a whole number from 1 to 2147483647, not 0");
  refuse("--resolution 64.5", "--resolution: must be a whole number");
  refuse("--resolution 3000000000", "--resolution: must be a whole number");
  refuse("--resolution many", "--resolution");
  refuse("--voxel-size 0", "--voxel-size");
  refuse("--voxel-size nan", "--voxel-size: must be a number above 0, not nan");
  refuse("--voxel-size 1 --resolution 3", "--resolution excludes --voxel-size");
  refuse("--bounds 0 0 0 1 1", "--bounds");
  refuse("--bounds 1 0 0 0 1 1", "--bounds: each of x0 y0 z0 must be less");
  refuse("--padding -1", "--padding");
  refuse("--band -3", "--band");
  refuse("--threshold 0", "--threshold");
  refuse("--passes 0", "--passes");
  refuse("--threads -1", "--threads");
  refuse("--distance roughly", "--distance");
  refuse("--sign none --winding w.npy", "--winding and --confidence need a sign");
  refuse("--distance raster --triangle-ids t.npy", "--triangle-ids needs another distance");
  refuse("--winding f.nrrd", "another option already writes this file");
  refuse("--winding w.txt", "must end in one of");
  refuse("--stats stats.txt", "must end in .json");
  refuse("--no-such-option 1", "not understood: --no-such-option 1; see raymap generate --help");
  expectFailure("generate torus.ply", ErrorCode::Usage, "--output is required; see raymap generate --help");
  expectFailure("generate torus.ply -o f.txt", ErrorCode::Usage, ".nrrd");
  expectFailure("", ErrorCode::Usage,
                "name a command: generate info query mesh render repair compare convert example devices;");
  expectFailure("paint torus.ply", ErrorCode::Usage,
                "convert example devices; paint is none; see raymap --help");
  expectFailure("render torus.txt -o f.png", ErrorCode::File, "torus.txt: no such file");
  std::ofstream(path("text.txt")) << "text\n";
  expectFailure("render text.txt -o f.png", ErrorCode::Unsupported, ".obj .ply .stl");
  expectFailure("render text.txt -o f.png", ErrorCode::Unsupported, ".npz");
  fs::remove(path("text.txt"));
  expectFailure("render torus.ply -o f.png --index 3", ErrorCode::Usage, "--index requires --slice");
  expectFailure("render torus.ply -o f.png --direction 0 1 0", ErrorCode::Usage, "--direction and --up");
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(Cli, NamesTheFileThatIsWrong) {
  writeTorus();
  std::ofstream(path("text.ply")) << "This is no mesh.\n";
  std::ofstream(path("text.nrrd")) << "This is no field.\n";
  expectFailure("info nothing.ply", ErrorCode::File, "nothing.ply");
  expectFailure("info text.ply", ErrorCode::Input, "text.ply");
  expectFailure("convert text.nrrd f.npz", ErrorCode::Input, "text.nrrd");
  expectFailure("generate torus.ply -o no/f.nrrd", ErrorCode::File, "there is no folder no");
  expectFailure("generate torus.ply -o f.nrrd --memory-limit 1MB --resolution 200", ErrorCode::Memory, "");
  EXPECT_FALSE(fs::exists(path("f.nrrd")));
}

TEST_F(Cli, TakesTheNumberOfThreadsFromTheVariable) {
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

TEST_F(Cli, ReadsSizesOfMemory) {
  writeTorus();
  const std::string generate = "generate torus.ply -o f.nrrd --resolution 32 --memory-limit ";
  for (const char* enough : {"1.5GB", "1e9", "'1.5 gb'", "2000000k", "0.5GiB", "300M", "9437184", "1T", "0"})
    succeed(generate + enough);
  const auto refuses = [&](const std::string& size, const std::string& limit) {
    expectFailure(generate + size, ErrorCode::Memory, ", but only " + limit + " may be used");
  };
  refuses("12", "12 bytes");
  refuses("1.5", "1 byte");
  refuses("1e3", "1000 bytes");
  refuses("0.5KB", "512 bytes");
  refuses("3.75k", "3 KiB");
  refuses("1e5B", "97 KiB");
  refuses("0.0001GiB", "104 KiB");
  refuses("0.1MB", "102 KiB");
  for (const char* wrong :
       {"much", "-1", "1.5XB", "GB", "1e", "nan", "inf", "1e30", "5000000T", "1.5GBs", "''"})
    expectFailure(generate + wrong, ErrorCode::Usage, "must be a size such as 500MB, 1.5GB or 1e9, not ");
}

TEST_F(Cli, ReadsMeshesFromPipes) {
  const std::regex unit("\"unit\": [^,]*,");
  writeTorus();
  for (const std::string format : {"ply", "obj", "stl", "glb"}) {
    SCOPED_TRACE(format);
    succeed("convert torus.ply m." + format);
    const std::string alone = succeed("info m." + format + " --json").out;
    for (const char* line :
         {"cat m.FORMAT | $R info - --json", "cat m.FORMAT | $R info - --json --format FORMAT",
          "$R info /dev/stdin --json < m.FORMAT", "$R info <(cat m.FORMAT) --json",
          "cp m.FORMAT unnamed; $R info unnamed --json --format .FORMAT"}) {
      std::string command = line;
      for (size_t at = 0; (at = command.find("FORMAT")) != std::string::npos;) command.replace(at, 6, format);
      const Result piped = shell(command);
      EXPECT_EQ(piped.code, 0) << command << "\n" << piped.err;
      // The bytes of a pipe tell the format, but not which unit its programs take for granted.
      EXPECT_EQ(std::regex_replace(piped.out, unit, ""), std::regex_replace(alone, unit, "")) << command;
    }
  }
}

TEST_F(Cli, WritesFieldsToPipes) {
  writeTorus();
  for (const std::string& extension : fieldExtensions()) {
    SCOPED_TRACE(extension);
    const std::string options = "generate torus.ply --resolution 16 ";
    succeed(options + "-o whole" + extension);
    const Result piped = shell("$R " + options + "-o - --format " + extension.substr(1) + " | cat");
    EXPECT_EQ(piped.out, readBytes(path("whole" + extension)));
    EXPECT_NE(piped.err.find("grid: "), std::string::npos) << piped.err;
    EXPECT_NE(piped.err.find("wrote standard output\n"), std::string::npos) << piped.err;
    const Result filed = shell("(echo before; $R " + options + "-o /dev/stdout --format " + extension +
                               "; echo after) 2>.text");
    EXPECT_EQ(filed.out, "before\n" + piped.out + "after\n");
    const Result read = shell("cat whole" + extension + " | $R convert - - --format nrrd 2>.text");
    succeed("convert whole" + extension + " converted.nrrd");
    EXPECT_EQ(read.out, readBytes(path("converted.nrrd")));
  }
  succeed("mesh whole.nrrd -o whole.stl");
  EXPECT_EQ(shell("$R mesh - -o - --format stl < whole.nrrd 2>.text").out, readBytes(path("whole.stl")));
  EXPECT_EQ(shell("$R repair - -o - --format ply --resolution 32 < torus.ply 2>.text | $R info - --json | "
                  "grep watertight")
                .out,
            "  \"watertight\": true,\n");
  EXPECT_EQ(shell("$R render - -o - --resolution 16 --size 8 8 < torus.ply 2>.text | head -c 4").out,
            "\x89PNG");
  EXPECT_EQ(shell("$R compare <(cat whole.nrrd) whole.npz --json | grep max").out, "  \"max\": 0.0,\n");
  const Result both = shell("$R generate torus.ply --resolution 16 -o f.nrrd --stats - 2>.text");
  EXPECT_EQ(Json::parse(both.out)["mesh"]["file"], "torus.ply");
}

TEST_F(Cli, MeasuresPointsFromPipes) {
  writeTorus();
  succeed("query torus.ply torus.ply -o whole.csv");
  EXPECT_EQ(shell("$R query torus.ply - -o - --format csv < torus.ply 2>.text").out,
            readBytes(path("whole.csv")));
  EXPECT_EQ(shell("printf '2,0,0\\n' | $R query torus.ply - -o - --format csv 2>.text")
                .out.rfind("x,y,z,distance\n2,0,0,-0.6", 0),
            0u);
  EXPECT_EQ(shell("printf '2 0 0 9 9\\n' | $R query torus.ply - -o - --format npy 2>.text | head -c 6").out,
            "\x93NUMPY");
  EXPECT_EQ(shell("cat torus.ply | $R query - torus.ply -o r.csv && cat r.csv").code, 0);
  EXPECT_EQ(readBytes(path("r.csv")), readBytes(path("whole.csv")));
}

TEST_F(Cli, KeepsPipesAndEndsWithThem) {
  writeTorus();
  EXPECT_EQ(shell("mkfifo pipe; cat pipe > got.ply & $R convert torus.ply pipe --format ply; wait").code, 0);
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  succeed("convert torus.ply whole.ply");
  EXPECT_EQ(readBytes(path("got.ply")), readBytes(path("whole.ply")));

  const Result closed =
      shell("($R generate torus.ply --resolution 100 -o - --format nrrd; echo $? >code) | true");
  EXPECT_EQ(readBytes(path("code")), "4\n");
  EXPECT_NE(
      closed.err.find("raymap: error: standard output: cannot write: Broken pipe; the program that reads it "
                      "has ended\n"),
      std::string::npos)
      << closed.err;
  EXPECT_EQ(shell("$R info torus.ply > /dev/full").err,
            "raymap: error: standard output: cannot write the text: No space left on device\n");
  EXPECT_EQ(shell("$R generate torus.ply -o - --format nrrd >&-").code, 4);

  // A file on stdout stays empty if the work fails.
  const Result failed = shell("$R generate torus.ply -o - --format nrrd --memory-limit 1MB --resolution 200");
  EXPECT_EQ(failed.code, 5);
  EXPECT_EQ(failed.out, "");
}

TEST_F(Cli, NamesTheFormatsOfPipes) {
  writeTorus();
  const auto usage = ErrorCode::Usage;
  expectFailure(
      "generate torus.ply -o -", usage,
      "--output /dev/stdout: the name must end in one of .nrrd .npy .npz .vti .vdb, or --format must name");
  expectFailure("generate torus.ply -o f.nrrd --format npy", usage,
                "--format npy: the names of all files tell");
  expectFailure("generate torus.ply -o - --format stl", usage, "--format stl: must be one of .nrrd .npy");
  expectFailure("generate torus.ply -o - --format nrrd --winding -", usage,
                "another option already writes this");
  expectFailure("generate torus.ply -o f --format nrrd --stats f.txt", usage, "must end in .json");
  expectFailure("compare - -", usage, "standard input can be read once only");
  expectFailure("info -", ErrorCode::Unsupported, "/dev/stdin: neither its name nor its bytes tell");
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(Cli, MeasuresPoints) {
  writeTorus();
  std::ofstream(path("p.csv")) << "name,x,y,z\nin,2,0,0\nout,0,0,0\nlost,nan,0,0\n";
  const Result result = succeed("query torus.ply p.csv -o r.csv --arrays triangle,distance --stats s.json");
  EXPECT_NE(result.out.find("p.csv: 3 points, 1 not finite"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(", 1 point inside"), std::string::npos) << result.out;
  std::istringstream rows(readBytes(path("r.csv")));
  std::string header, in, out, lost;
  for (std::string* row : {&header, &in, &out, &lost}) std::getline(rows, *row);
  EXPECT_EQ(header, "x,y,z,distance,triangle");
  EXPECT_EQ(in.rfind("2,0,0,-0.6", 0), 0u) << in;
  EXPECT_EQ(out.rfind("0,0,0,1.", 0), 0u) << out;
  EXPECT_EQ(lost, "nan,0,0,nan,-1");
  const Json stats = json("s.json");
  EXPECT_EQ(stats["points"]["count"], 3);
  EXPECT_EQ(stats["points"]["not_finite"], 1);
  EXPECT_EQ(stats["options"]["arrays"], Json({"distance", "triangle"}));
  EXPECT_TRUE(stats["options"]["max_distance"].is_null());
  EXPECT_EQ(stats["distances"]["inside"], 1);
  EXPECT_EQ(stats["turned_faces"], 0);
}

TEST_F(Cli, MeasuresPointsWithoutASign) {
  writeTorus();
  std::ofstream(path("p.xyz")) << "2 0 0\n0 0 0\n";
  succeed("query torus.ply p.xyz -o r.csv --unsigned --max-distance 1 --stats s.json");
  const std::string rows = readBytes(path("r.csv"));
  EXPECT_EQ(rows.rfind("x,y,z,distance\n2,0,0,0.6", 0), 0u) << rows;
  EXPECT_NE(rows.find("\n0,0,0,1\n"), std::string::npos) << rows;
  EXPECT_EQ(json("s.json")["options"]["max_distance"], 1.0);
  EXPECT_FALSE(json("s.json").contains("turned_faces"));
}

TEST_F(Cli, ColoursAPointCloud) {
  writeTorus();
  succeed("query torus.ply torus.ply -o r.ply --colour");
  const std::string bytes = readBytes(path("r.ply"));
  EXPECT_NE(bytes.find("element vertex 960\n"), std::string::npos);
  EXPECT_NE(bytes.find("property float distance\nproperty uchar red\n"), std::string::npos);
  EXPECT_EQ(readPoints(path("r.ply")).size(), 960u);
}

TEST_F(Cli, RefusesQueriesThatMakeNoSense) {
  writeTorus();
  std::ofstream(path("p.csv")) << "1,2,3\n1,2\n";
  const auto usage = ErrorCode::Usage;
  expectFailure("query torus.ply p.csv -o r.csv", ErrorCode::Input,
                "p.csv: line 2: 2 columns, but line 1 has 3");
  expectFailure("query torus.ply p.csv -o r.txt", usage, "the name must end in one of .csv .npy .npz .ply");
  succeed("convert torus.ply torus.stl");
  expectFailure("query torus.ply torus.stl -o r.csv", usage, "'.stl' is no kind of file of points");
  fs::remove(path("torus.stl"));
  expectFailure("query torus.ply p.csv -o r.npy --arrays distance,closest", usage, "a .npy holds one array");
  expectFailure("query torus.ply p.csv -o r.csv --colour", usage, "--colour needs");
  expectFailure("query torus.ply p.csv -o r.ply --colour --arrays winding", usage, "--colour needs");
  expectFailure("query torus.ply p.csv -o r.csv --unsigned --arrays winding", usage, "leave out --unsigned");
  expectFailure("query torus.ply p.csv -o r.csv --arrays length", usage, "length not in");
  expectFailure("query torus.ply p.csv -o r.csv --max-distance 0", usage, "must be a number above 0");
  expectFailure("query torus.ply torus.ply -o r.csv --memory-limit 30kB", ErrorCode::Memory,
                "960 points and their results need 30.7 kB, which leaves nothing of the 30.7 kB");
  expectFailure("query torus.ply torus.ply -o r.csv --memory-limit 40kB", ErrorCode::Memory, "");
  EXPECT_EQ(fileCount(), 2u);
}

}  // namespace
}  // namespace raymap
