// Progress on stderr: its styles, and what a repair says of its time.

#include <map>
#include <memory>
#include <sstream>

#include "cli.h"
#include "terminal.h"

namespace raymap {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A printer into a file, with a clock that only the test moves.
class PrintedProgress : public ::testing::Test {
 protected:
  void start(ProgressStyle style) {
    printer_ = std::make_unique<ProgressPrinter>(file_.get(), style, now_);
    printer_->begin(now_);
  }
  void show(const char* stage, std::optional<double> done, Clock::duration later) {
    now_ += later;
    printer_->show(stage, done, now_);
  }

  /// Returns what was printed since the last call.
  std::string printed() {
    const long end = std::ftell(file_.get());
    std::string text(size_t(end - read_), '\0');
    std::fseek(file_.get(), read_, SEEK_SET);
    EXPECT_EQ(std::fread(text.data(), 1, text.size(), file_.get()), text.size());
    std::fseek(file_.get(), end, SEEK_SET);
    read_ = end;
    return text;
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{std::tmpfile(), &std::fclose};
  long read_ = 0;
  std::unique_ptr<ProgressPrinter> printer_;
  Clock::time_point now_ = Clock::time_point(std::chrono::hours(1));
};

TEST_F(PrintedProgress, IsALineAMinuteIfPlain) {
  start(ProgressStyle::Plain);
  show("crossings", 0.0, seconds(0));
  show("sign", 0.5, seconds(59));
  EXPECT_EQ(printed(), "");
  show("sign", 0.454, seconds(1));
  EXPECT_EQ(printed(), "raymap: 60 s: sign 45 %\n");
  printer_->begin(now_);  // A minute goes on from one piece of work to the next.
  show("simplify", 0.1, seconds(59));
  EXPECT_EQ(printed(), "");
  show("reading a.ply", std::nullopt, seconds(2));
  EXPECT_EQ(printed(), "raymap: 121 s: reading a.ply\n");
  show("simplify", 0.2, seconds(59));
  EXPECT_EQ(printed(), "");
  printer_->interrupt("a warning");
  printer_->clear();
  EXPECT_EQ(printed(), "a warning\n");
}

TEST_F(PrintedProgress, IsAnObjectASecondAndAStageIfJson) {
  start(ProgressStyle::Json);
  show("sign", 0.0, milliseconds(20));
  show("sign", 0.1, milliseconds(999));
  EXPECT_EQ(printed(), "{\"stage\":\"sign\",\"done\":0.0,\"seconds\":0.02}\n");
  show("sign", 0.12345, milliseconds(1));
  EXPECT_EQ(printed(), "{\"stage\":\"sign\",\"done\":0.123,\"seconds\":1.02}\n");
  show("finish", 1.0, milliseconds(1));
  EXPECT_EQ(printed(), "{\"stage\":\"finish\",\"done\":1.0,\"seconds\":1.02}\n");
  printer_->begin(now_);
  show("finish", std::nullopt, milliseconds(1));
  EXPECT_EQ(printed(), "{\"stage\":\"finish\",\"done\":null,\"seconds\":1.02}\n");
  printer_->clear();
  show("\xff\n", 0.0, milliseconds(0));
  EXPECT_EQ(printed(), "{\"stage\":\"\xef\xbf\xbd\\n\",\"done\":0.0,\"seconds\":1.02}\n");
}

TEST_F(PrintedProgress, MovesAfterASecondOfEachPieceOfWork) {
  start(ProgressStyle::Moving);
  show("sign", 0.5, milliseconds(999));
  printer_->clear();
  EXPECT_EQ(printed(), "");
  show("sign", 0.5, milliseconds(1));
  show("sign", 0.6, milliseconds(99));
  EXPECT_EQ(printed(), "\r\033[K  sign  50 %");
  show("sign", 0.6, milliseconds(1));
  EXPECT_EQ(printed(), "\r\033[K  sign  60 %");
  printer_->interrupt("a warning");
  EXPECT_EQ(printed(), "\r\033[Ka warning\n");
  printer_->clear();
  EXPECT_EQ(printed(), "");
  printer_->begin(now_);
  show("reading a.ply", std::nullopt, milliseconds(999));
  EXPECT_EQ(printed(), "");
  show("reading a.ply", std::nullopt, seconds(2));
  EXPECT_EQ(printed(), "\r\033[K  reading a.ply, 3 s");
  printer_->clear();
  EXPECT_EQ(printed(), "\r\033[K");
}

TEST_F(PrintedProgress, IsNothingIfOff) {
  start(ProgressStyle::Off);
  show("sign", 0.5, std::chrono::hours(1));
  printer_->clear();
  EXPECT_EQ(printed(), "");
}

TEST_F(PrintedProgress, IsPlainByDefaultWhereNoLineCanMove) {
  EXPECT_EQ(defaultProgressStyle(TextLevel::Normal, true), ProgressStyle::Moving);
  EXPECT_EQ(defaultProgressStyle(TextLevel::Normal, false), ProgressStyle::Plain);
  EXPECT_EQ(defaultProgressStyle(TextLevel::Verbose, true), ProgressStyle::Plain);
  EXPECT_EQ(defaultProgressStyle(TextLevel::Quiet, true), ProgressStyle::Off);
}

class CliProgress : public Cli {
 protected:
  /// Returns the stages of lines of JSON.
  static std::vector<std::string> stages(const std::string& lines) {
    std::vector<std::string> names;
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);) {
      const Json json = Json::parse(line);
      EXPECT_EQ(json.size(), 3u) << line;
      EXPECT_GE(json["done"].get<double>(), 0.0) << line;
      EXPECT_LE(json["done"].get<double>(), 1.0) << line;
      EXPECT_GT(json["seconds"].get<double>(), -1e-9) << line;
      names.push_back(json["stage"]);
    }
    return names;
  }
};

TEST_F(CliProgress, IsJsonOfEveryCommandThatTakesLong) {
  writeTorus();
  std::ofstream(path("p.csv")) << "x,y,z\n0,0,0\n";
  const auto expectStage = [&](const std::string& command, const char* stage) {
    const Result result = run(command);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_GT(std::ranges::count(stages(result.err), stage), 0) << command << "\n" << result.err;
  };
  expectStage("generate torus.ply -o f.nrrd --resolution 16 --device cpu --progress json", "exact_distance");
  expectStage("--progress json info torus.ply", "crossing pairs");
  expectStage("--progress=json -q query torus.ply p.csv -o r.csv", "tree");
  expectStage("sample torus.ply -o s.npz -n 100 --progress JSON", "tree");
  expectStage("mesh f.nrrd -o m.ply --progress json", "isosurface");
  expectStage("render f.nrrd -o r.png --size 40 30 --device cpu --progress json", "render");
  // The search for the thinnest part, which chooses the grid, is named, too.
  expectStage("repair torus.ply -o s.ply --remesh --device cpu --progress json", "thickness");
}

TEST_F(CliProgress, LeavesShortRunsSilent) {
  writeTorus();
  for (const char* style : {"", " --progress plain", " --progress off"})
    succeed("generate torus.ply -o f.nrrd --resolution 16" + std::string(style));
  expectFailure("info torus.ply --progress fast", ErrorCode::Usage,
                "--progress: must be one of plain, json, off, not fast");
  expectFailure("--progress", ErrorCode::Usage, "--progress");
}

TEST_F(CliProgress, NamesTheSlowestStepOfARepair) {
  writeTorus();
  const Result brief = succeed("repair torus.ply -o s.ply --resolution 32 --remesh");
  EXPECT_TRUE(std::regex_search(brief.out, std::regex("\ntime: [0-9.]+ s\n"))) << brief.out;
  const Result result = run("repair torus.ply -o s.ply --resolution 32 --remesh --stats s.json --verbose");
  const Json stats = json("s.json");
  std::map<std::string, double> sums;
  for (const Json& step : stats["steps"]) sums[step["name"]] += step["milliseconds"].get<double>();
  for (const char* step : {"load", "fit", "exact_distance", "simplify", "write"})
    EXPECT_EQ(sums.count(step), 1u) << step;
  const std::string slowest = stats["slowest_step"];
  for (const auto& [name, milliseconds] : sums) EXPECT_LE(milliseconds, sums[slowest]) << name;
  EXPECT_NE(result.out.find("; the longest step, " + slowest + ", took "), std::string::npos) << result.out;
}

TEST_F(CliProgress, TellsBeforehandWhyARepairTakesLong) {
  writeMesh(path("plate.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0, 1.0, 0.004)));
  // Ends the repair after its first line.
  const Result result = shell(
      "mkfifo p; $R repair plate.ply -o o.ply --remesh --device cpu >p & read -r line <p\n"
      "kill %1; wait; echo \"$line\"");
  EXPECT_EQ(result.out,
            "this takes a while: about 5e+05 cubes of samples at the surface, because the thinnest part is "
            "0.004 thick; --resolution 256 takes 18 % of them, but is too coarse for that part\n");
}

}  // namespace
}  // namespace raymap
