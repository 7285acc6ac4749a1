#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliCheck : public Cli {
 protected:
  void SetUp() override {
    const Mesh torus = shapes::torus(2.0, 0.7, 40, 24), ball = shapes::sphere(1.5, 3);
    writeMesh(path("good.ply"), torus);
    writeMesh(path("crossing.ply"), shapes::joined(torus, ball));
    Mesh torn = torus;
    torn.triangles.pop_back();
    writeMesh(path("torn.ply"), torn);
  }
};

TEST_F(CliCheck, TellsGoodFromBad) {
  EXPECT_EQ(succeed("check good.ply good.ply").out,
            "good.ply: good, a clean solid, with nothing wrong.\ngood.ply: good, a clean solid, with nothing "
            "wrong.\n");
  const Result bad = run("check good.ply torn.ply");
  EXPECT_EQ(bad.code, 11);
  EXPECT_EQ(bad.err, "");
  EXPECT_EQ(bad.out.rfind(
                "good.ply: good, a clean solid, with nothing wrong.\ntorn.ply: bad, a solid with holes", 0),
            0u)
      << bad.out;
  EXPECT_EQ(run("check crossing.ply").code, 11);
  EXPECT_NE(succeed("check crossing.ply --fast").out.find("not looked for (--fast).\n"), std::string::npos);
  EXPECT_EQ(shell("cat torn.ply | $R check -").code, 11);
}

TEST_F(CliCheck, AgreesWithRepairOnHowPartsLie) {
  const auto cube = [](double low, double high) { return shapes::box(glm::dvec3(low), glm::dvec3(high)); };
  struct Case {
    Mesh other;
    const char *checked, *repaired;
  };
  const Case cases[] = {
      {cube(2, 8), "bad, 2 closed parts, solids in solids: none faces inwards, as a cavity does.",
       "parts of it face the wrong way"},
      {shapes::inverted(cube(12, 18)),
       "bad, 2 closed parts, some of which face the wrong way: ", "parts of it face the wrong way"},
      {shapes::box({10, 2, 2}, {20, 8, 8}),
       "bad, 2 closed parts that touch: 2 pairs of faces overlap in one plane.", "parts of it touch"},
      {shapes::box({5, 0, 0}, {15, 10, 10}),
       "bad, 2 closed parts that overlap: 12 pairs of faces overlap in one plane.", "parts of it overlap"},
      {cube(5, 15), "bad, 2 closed parts that overlap: ", "parts of it overlap"},
      {cube(12, 18), "good, 2 clean, separate solids, with nothing wrong.", "kept as it is"},
      {shapes::inverted(cube(2, 8)), "good, a clean solid and a cavity ", "kept as it is"}};
  for (const Case& each : cases) {
    writeMesh(path("two.ply"), shapes::joined(cube(0, 10), each.other));
    const std::string checked = run("check two.ply").out;
    EXPECT_NE(checked.find(each.checked), std::string::npos) << checked;
    const std::string info = succeed("info two.ply").out;
    EXPECT_EQ(info.find("To make it a clean solid") == std::string::npos,
              checked.starts_with("two.ply: good"));
    const std::string repaired = run("repair two.ply -o one.ply --resolution 32").out;
    EXPECT_NE(repaired.find(each.repaired), std::string::npos) << repaired;
  }
}

TEST_F(CliCheck, ChecksTheOthersBesideAnError) {
  std::ofstream(path("broken.ply")) << "ply\n";
  const Result result = run("check broken.ply torn.ply gone.ply good.ply");
  EXPECT_EQ(result.code, exitCode(ErrorCode::Input));
  EXPECT_EQ(result.err.rfind("raymap: error: broken.ply: ", 0), 0u) << result.err;
  EXPECT_NE(result.err.find("\nraymap: error: gone.ply: cannot read it"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("good.ply: good"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("torn.ply: bad"), std::string::npos) << result.out;
}

TEST_F(CliCheck, PrintsALineOfJsonForEach) {
  const Result result = run("check good.ply torn.ply gone.ply --json --quiet --unit mm");
  EXPECT_EQ(result.code, exitCode(ErrorCode::File));
  std::istringstream lines(result.out);
  std::string line;
  std::vector<Json> found;
  while (std::getline(lines, line)) found.push_back(Json::parse(line));
  ASSERT_EQ(found.size(), 3u) << result.out;
  EXPECT_EQ(found[0]["file"], "good.ply");
  EXPECT_TRUE(found[0]["good"]);
  EXPECT_EQ(found[0]["unit"], "mm");
  EXPECT_FALSE(found[1]["good"]);
  EXPECT_EQ(found[1]["verdict"]["kind"], "open_solid");
  EXPECT_EQ(found[1]["boundary_edges"], 3);
  EXPECT_EQ(found[2]["error"], "file");
}

}  // namespace
}  // namespace raymap
