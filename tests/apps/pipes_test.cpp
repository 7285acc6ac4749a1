// Standard input and output, and named pipes, in the place of files.

#include <regex>

#include "cli.h"

namespace raymap {
namespace {

class CliPipes : public Cli {};

TEST_F(CliPipes, ReadsMeshesFromPipes) {
  const std::regex differs(R"("unit": [^,]*,|"file": .*)");
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
      EXPECT_EQ(std::regex_replace(piped.out, differs, ""), std::regex_replace(alone, differs, ""))
          << command;
    }
  }
}

TEST_F(CliPipes, WritesFieldsToPipes) {
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
  EXPECT_EQ(shell("$R compare <(cat whole.nrrd) whole.npz --json | grep max").out, "  \"max_error\": 0.0,\n");
  const Result both = shell("$R generate torus.ply --resolution 16 -o f.nrrd --stats - 2>.text");
  EXPECT_EQ(Json::parse(both.out)["mesh"], "torus.ply");
}

TEST_F(CliPipes, MeasuresPointsFromPipes) {
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

TEST_F(CliPipes, KeepsPipesAndEndsWithThem) {
  writeTorus();
  EXPECT_EQ(shell("mkfifo pipe; cat pipe > got.ply & $R convert torus.ply pipe --format ply; wait").code, 0);
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  succeed("convert torus.ply whole.ply");
  EXPECT_EQ(readBytes(path("got.ply")), readBytes(path("whole.ply")));

  // A closed pipe ends the program as it ends other tools; a pipe that is ignored is an error.
  const std::string ended = "the program that reads it has ended\n";
  for (const auto& [command, error] : std::vector<std::pair<std::string, std::string>>{
           {"generate torus.ply --resolution 100 -o - --format nrrd -q",
            "cannot write: Broken pipe; " + ended},
           {"manual --table", "cannot write the text: " + ended},
           {"check torus.ply torus.ply --json", "cannot write the text: " + ended}}) {
    EXPECT_EQ(shell("(sleep 0.2; exec $R " + command + ") | true; echo ${PIPESTATUS[0]}").out, "141\n");
    EXPECT_EQ(shell("(sleep 0.2; exec $R " + command + ") | true").err, "");
    const Result kept =
        shell("(trap '' PIPE; sleep 0.2; exec $R " + command + ") | true; echo ${PIPESTATUS[0]}");
    EXPECT_EQ(kept.out, "4\n");
    EXPECT_EQ(kept.err, "raymap: error: standard output: " + error);
  }
  EXPECT_EQ(fileCount(), 4u);
  // Other errors are told, whoever reads.
  EXPECT_EQ(shell("$R convert none.ply -o - --format ply | true").err,
            "raymap: error: none.ply: cannot read it: No such file or directory\n");
  const std::string isFull =
      "raymap: error: standard output: cannot write the text: No space left on device\n";
  for (const char* command :
       {"check torus.ply torus.ply --json", "check torus.ply torus.ply", "manual --table"})
    EXPECT_EQ(shell(std::string("$R ") + command + " > /dev/full").err, isFull) << command;
  EXPECT_EQ(shell("$R check torus.ply torus.ply --json > /dev/full").code, 4);
  EXPECT_EQ(shell("$R info torus.ply > /dev/full").err,
            "raymap: error: standard output: cannot write the text: No space left on device\n");
  EXPECT_EQ(shell("$R generate torus.ply -o - --format nrrd >&-").code, 4);

  // A file on stdout stays empty if the work fails.
  const Result failed = shell("$R generate torus.ply -o - --format nrrd --memory-limit 1MB --resolution 200");
  EXPECT_EQ(failed.code, 5);
  EXPECT_EQ(failed.out, "");
}

TEST_F(CliPipes, NamesTheFormatsOfPipes) {
  writeTorus();
  const auto usage = ErrorCode::Usage;
  expectFailure("generate torus.ply -o -", usage,
                "--output standard output: the name must end in one of .nrrd .npy .npz .vti .vdb .nvdb, or "
                "--format must name");
  expectFailure("generate torus.ply -o f.nrrd --format npy", usage, "--format npy: is not what the names of");
  expectFailure("generate torus.ply -o - --format stl", usage, "--format stl: must be one of .nrrd .npy");
  expectFailure("generate torus.ply -o - --format nrrd --winding -", usage,
                "another option already writes this");
  expectFailure("generate torus.ply -o f --format nrrd --stats f.txt", usage, "must end in .json");
  expectFailure("compare - -", usage, "standard input can be read once only");
  expectFailure("info -", ErrorCode::Unsupported, "standard input: neither its name nor its bytes tell");
  EXPECT_EQ(fileCount(), 1u);
}

}  // namespace
}  // namespace raymap
