#include "cli.h"

namespace raymap {
namespace {

class CliMain : public Cli {};

TEST_F(CliMain, PrintsHelpAndVersion) {
  EXPECT_NE(succeed("--version").out.find("raymap 0."), std::string::npos);
  const std::string help = succeed("--help").out;
  for (const char* word : {"generate", "info", "check", "query", "mesh", "render", "view", "repair",
                           "compare", "convert", "example", "devices", "Exit codes"})
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

// OpenVDB takes longer to load than all else.
TEST_F(CliMain, LoadsOpenVdbForItsFilesAlone) {
  const Result loaded = run("--version", "LD_TRACE_LOADED_OBJECTS=1");
  EXPECT_NE(loaded.out.find("libtbb"), std::string::npos) << loaded.out;
  EXPECT_EQ(loaded.out.find("openvdb"), std::string::npos) << loaded.out;
}

TEST_F(CliMain, SaysThatALibraryIsMissing) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP() << "without OpenVDB";
  writeTorus();
  const Result result = shell("cp $R alone && ./alone generate torus.ply -o torus.vdb --resolution 20");
  if (result.code == 0) GTEST_SKIP() << "raymap-vdb.plugin is installed where every program finds it";
  EXPECT_EQ(result.code, exitCode(ErrorCode::Unsupported)) << result.err;
  EXPECT_NE(result.err.find("the library raymap-vdb.plugin that does is missing"), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(path("torus.vdb")));
  const Result found =
      shell("RAYMAP_IMPORT=$R-import ./alone generate torus.ply -o torus.vdb --resolution 20");
  EXPECT_EQ(found.code, 0) << found.err;
}

TEST_F(CliMain, SaysThatALibraryIsNotItsOwn) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP() << "without OpenVDB";
  writeTorus();
  const std::string generate = " && ./alone generate torus.ply -o torus.vdb --resolution 20";
  const Result noLibrary = shell("cp $R alone && echo text >raymap-vdb.plugin" + generate);
  EXPECT_EQ(noLibrary.code, exitCode(ErrorCode::Unsupported)) << noLibrary.err;
  EXPECT_NE(noLibrary.err.find("cannot write a .vdb or .nvdb: "), std::string::npos) << noLibrary.err;
  const Result another =
      shell("cp $R alone && cp $(ldd $R | awk '/libm[.]so/ {print $3}') raymap-vdb.plugin" + generate);
  EXPECT_EQ(another.code, exitCode(ErrorCode::Unsupported)) << another.err;
  EXPECT_NE(another.err.find("raymap-vdb.plugin is of another version"), std::string::npos) << another.err;
  EXPECT_FALSE(fs::exists(path("torus.vdb")));
}

TEST_F(CliMain, ShowsOptionsAsTheyAreWritten) {
  for (const char* command : {"generate", "info", "check", "query", "mesh", "render", "view", "repair",
                              "compare", "convert", "example", "devices"}) {
    const std::string help = succeed(std::string(command) + " --help").out;
    for (const char* oddity : {"{false}", "{true}", "[0]", "(=1024b)", "INT in ["})
      EXPECT_EQ(help.find(oddity), std::string::npos) << help;
  }
  EXPECT_NE(succeed("repair --help").out.find("--close-holes, --no-close-holes"), std::string::npos);
}

TEST_F(CliMain, FailsWhereItsTextIsLost) {
  for (const char* arguments : {"--version", "--help", "repair --help"}) {
    const Result result = shell(std::string("$R ") + arguments + " >/dev/full");
    EXPECT_EQ(result.code, exitCode(ErrorCode::File)) << arguments;
    EXPECT_EQ(result.err, "raymap: error: standard output: cannot write the text: No space left on device\n");
  }
}

TEST_F(CliMain, NamesTheCommands) {
  expectFailure(
      "", ErrorCode::Usage,
      "name a command: generate info check query sample mesh render view repair simplify compare convert "
      "example devices completion manual;");
  expectFailure("paint torus.ply", ErrorCode::Usage,
                "unknown command 'paint'; use one of: generate info check query sample mesh render view");
}

}  // namespace
}  // namespace raymap
