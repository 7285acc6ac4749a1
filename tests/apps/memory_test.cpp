// The command line's peak memory, by default and with --memory-limit.

#include <cctype>
#include <sstream>

#include "cli.h"
#include "run_program.h"

namespace raymap {

namespace {

// A default field at 256^3 takes at most 24 bytes a sample plus 200 bytes a triangle.
TEST(Memory, DefaultFieldStaysLean) {
  const TemporaryFolder folder;
  const std::string meshFile = folder.path() / "mesh.ply", fieldFile = folder.path() / "field.nrrd";
  const Mesh mesh = shapes::sphere(1.0, 5);
  writeMesh(meshFile, mesh);
  const ProgramRun run =
      runProgram({RAYMAP_BINARY, "generate", meshFile, "-o", fieldFile, "--resolution", "256"});
  EXPECT_EQ(run.code, 0) << run.error;
  const size_t samples = fitGrid(mesh, {.resolution = 256}).sampleCount();
  EXPECT_LE(run.peakBytes, 24 * samples + 200 * mesh.triangles.size());
}

TEST(Memory, AFarVertexTakesNoMorePointsOfASimplification) {
  const TemporaryFolder folder;
  const std::string far = folder.path() / "far.ply", fewer = folder.path() / "fewer.ply";
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices[6].z = 1e19f;
  writeMesh(far, mesh);
  const ProgramRun run = runProgram({RAYMAP_BINARY, "simplify", far, "-o", fewer, "--tolerance", "0.05"});
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_LE(run.peakBytes, size_t{300} << 20);
}

class CliMemory : public Cli {
 protected:
  /// Runs the program in the folder, with a limit of so many bytes, and expects that it keeps to it: it
  /// works, or says that memory is missing.
  ProgramRun runWithin(size_t limit, const std::string& arguments) const {
    std::vector<std::string> words{RAYMAP_BINARY};
    std::istringstream text(arguments);
    for (std::string word; text >> word;)
      words.push_back(word.find('.') < word.npos && !std::isdigit(word[0]) ? path(word).string() : word);
    words.insert(words.end(), {"--memory-limit", std::to_string(limit)});
    const ProgramRun run = runProgram(words);
    SCOPED_TRACE(arguments + ", " + std::to_string(limit));
    EXPECT_LE(run.peakBytes, limit) << run.code;
    EXPECT_TRUE(run.code == 0 || run.code == exitCode(ErrorCode::Memory)) << run.code << ": " << run.error;
    EXPECT_EQ(run.error.rfind("raymap: error: ", 0) == 0, run.code != 0) << run.error;
    return run;
  }

  /// Returns an option that allows so many megabytes beyond what the program itself takes.
  std::string allowing(size_t megabytes) const {
    writeMesh(path("box.ply"), shapes::box({0, 0, 0}, {1, 1, 1}));
    const ProgramRun least = runProgram({RAYMAP_BINARY, "generate", path("box.ply"), "-o", path("least.npy"),
                                         "--resolution", "8", "--device", "cpu"});
    fs::remove(path("box.ply"));
    fs::remove(path("least.npy"));
    constexpr size_t kUnplanned = 8 << 20;  // What the program sets aside.
    return " --memory-limit " + std::to_string(least.peakBytes + kUnplanned + megabytes * 1000 * 1000) + " ";
  }
};

// A field that does not fit into the memory allowed is written in slabs, and a run that failed is gone on
// with.
TEST_F(CliMemory, WritesSlabsOfWhatDoesNotFit) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  writeMesh(path("ball.ply"), mesh);
  const std::string make = "generate ball.ply --device cpu --resolution 180" + allowing(20);
  const Grid grid = fitGrid(mesh, {.resolution = 180});
  const auto expectWhole = [&](const std::string& name, double band) {
    const Field whole = Surface(mesh).generateRegion(grid, {{0, 0, 0}, grid.dims}, {.band = band});
    writeField(path("whole_" + name), whole);
    EXPECT_TRUE(readBytes(path(name)) == readBytes(path("whole_" + name))) << name;
  };
  for (const std::string& extension : slabExtensions()) {
    const Result result = succeed(make + "--band 3 -o slabs" + extension);
    EXPECT_NE(result.out.find("the field does not fit into memory, so it is written in slabs of "),
              std::string::npos)
        << result.out;
    expectWhole("slabs" + extension, 3.0);
  }
  const Result stopped = shell("trap '' XFSZ; ulimit -f 12000; $R " + make + "-o later.npy");
  EXPECT_EQ(stopped.code, exitCode(ErrorCode::File));
  EXPECT_NE(stopped.err.find("later.npy.part holds "), std::string::npos) << stopped.err;
  EXPECT_FALSE(fs::exists(path("later.npy")));
  const Result goesOn = run(make + "-o later.npy");
  EXPECT_EQ(goesOn.code, 0) << goesOn.err;
  EXPECT_NE(goesOn.err.find("later.npy: goes on after "), std::string::npos) << goesOn.err;
  EXPECT_FALSE(fs::exists(path("later.npy.part")));
  expectWhole("later.npy", 0.0);

  expectFailure(make + "-o field.npz", ErrorCode::Memory, "the field needs ");
  expectFailure(make + "-o field.npy --report r.json", ErrorCode::Memory, "the field needs ");
  expectFailure(make + "-o field.npy --winding w.npz", ErrorCode::Memory, "the field needs ");
  expectFailure("generate ball.ply --device cpu --resolution 100000 -o far.npy", ErrorCode::File,
                "far.npy.part: the file needs ");
}

TEST_F(CliMemory, WritesSlabsOfAllArrays) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  writeMesh(path("ball.ply"), mesh);
  const std::string make = "generate ball.ply --device cpu --resolution 120" + allowing(12);
  const Result result = succeed(make + "-o all.vti --winding w.npy --confidence c.nrrd --triangle-ids t.vti");
  EXPECT_NE(result.out.find("written in slabs of "), std::string::npos) << result.out;
  const Grid grid = fitGrid(mesh, {.resolution = 120});
  const Field whole = Surface(mesh).generateRegion(grid, {{0, 0, 0}, grid.dims},
                                                   {.triangle = true, .winding = true, .confidence = true});
  const auto expectFile = [&](const std::string& name, FieldArray array) {
    writeField(path("whole_" + name), whole, {.array = array});
    EXPECT_TRUE(readBytes(path(name)) == readBytes(path("whole_" + name))) << name;
    EXPECT_NE(result.out.find("wrote " + name), std::string::npos) << result.out;
  };
  expectFile("all.vti", FieldArray::Distance);
  expectFile("w.npy", FieldArray::Winding);
  expectFile("c.nrrd", FieldArray::Confidence);
  expectFile("t.vti", FieldArray::Triangle);
}

// Half of these need more than the lowest limit, and all less than the highest.
TEST_F(CliMemory, LimitsEveryCommand) {
  writeMesh(path("ball.ply"), shapes::sphere(1.0, 5));
  const std::string make = "generate ball.ply --device cpu ";
  for (const char* field : {"f.npz", "f.nrrd", "f.vti", "f.vdb", "f.nvdb"})
    succeed(make + "--resolution 160 -o " + field);
  for (const char* mesh : {"ball.stl", "ball.obj", "ball.3mf", "ball.glb"})
    succeed(std::string("convert ball.ply ") + mesh);
  size_t refused = 0;
  for (const char* command :
       {"info f.npz", "info f.vti", "convert f.npz o.vdb", "convert f.vdb o.npy", "compare f.nrrd f.vdb",
        "mesh f.nvdb -o o.ply", "render f.nrrd -o o.png --device cpu", "query f.vti ball.ply -o o.npy",
        "sample ball.ply -o o.npz", "check ball.3mf", "simplify ball.obj --triangles 5000 -o o.ply",
        "repair ball.stl -o o.ply --device cpu --resolution 60",
        "generate ball.glb -o o.vdb --device cpu --resolution 300 --band 3",
        "generate ball.ply -o o.nvdb --device cpu --resolution 160"}) {
    const bool writes = std::string_view(command).find(" -o ") != std::string_view::npos;
    const std::string line = command + std::string(writes ? " --overwrite" : "");
    refused += runWithin(80 * 1000 * 1000, line).code != 0 ? 1 : 0;
    EXPECT_EQ(runWithin(size_t{1} << 30, line).code, 0) << line;
  }
  EXPECT_GT(refused, 5u);
}

TEST_F(CliMemory, LimitsFieldsThatInflate) {
  const std::string head = "NRRD0004\\ntype: float\\ndimension: 3\\nsizes: 512 512 ",
                    rest = "\\nencoding: gzip\\nendian: little\\nspacings: 1 1 1\\n\\n";
  const auto writeZeros = [&](const std::string& name, const std::string& planes) {
    shell("printf '" + head + planes + rest + "' > " + name + "; head -c " + planes +
          "M /dev/zero | gzip >> " + name);
  };
  writeZeros("some.nrrd", "110");
  writeZeros("many.nrrd", "400");
  const ProgramRun some = runWithin(100 * 1000 * 1000, "info some.nrrd");
  EXPECT_EQ(some.code, exitCode(ErrorCode::Memory));
  EXPECT_NE(some.error.find("its samples need 110 MiB, and only "), std::string::npos) << some.error;
  expectFailure("info many.nrrd", ErrorCode::Input, "compressed bytes may stand for at most ");
}

TEST_F(CliMemory, SaysWhatTheProgramItselfNeeds) {
  writeTorus();
  expectFailure("info torus.ply --memory-limit 1MB", ErrorCode::Memory, "this process needs at least ");
}

}  // namespace

}  // namespace raymap
