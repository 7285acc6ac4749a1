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
  EXPECT_NE(succeed("check crossing.ply --fast").out.find("Faces that cross were not counted (--fast).\n"),
            std::string::npos);
  EXPECT_EQ(shell("cat torn.ply | $R check -").code, 11);
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
