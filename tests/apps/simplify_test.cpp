#include <regex>

#include "cli.h"

namespace raymap {
namespace {

class CliSimplify : public Cli {};

TEST_F(CliSimplify, WritesAsFewTrianglesAsAskedFor) {
  writeTorus();  // 1,920 triangles.
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb", "a.3mf"}) {
    const std::string text = succeed(std::string("simplify torus.ply --triangles 500 -o ") + name).out;
    EXPECT_TRUE(
        std::regex_search(text, std::regex("^(4[5-9][0-9]|500) triangles instead of 1,920, at most 0.0[0-9]+ "
                                           "off the mesh, with a tolerance of 0.0[0-9]+\nwrote a")))
        << text;
    const Diagnostics found = diagnose(readMesh(path(name)));
    EXPECT_LE(found.triangles, 500u) << name;
    EXPECT_TRUE(found.watertight && found.consistentlyOriented) << name;
    EXPECT_NEAR(found.signedVolume, 19.1, 0.8) << name;
  }
  // A .stl has three vertices for each triangle.
  succeed("simplify a.stl --max-triangles 300 -o b.ply --stats b.json");
  EXPECT_LE(readMesh(path("b.ply")).triangles.size(), 300u);
  const Json stats = json("b.json");
  EXPECT_EQ(stats["triangles_after"], readMesh(path("b.ply")).triangles.size());
  EXPECT_EQ(stats["vertices"], readMesh(path("b.ply")).vertices.size());
  EXPECT_EQ(stats["triangles_before"], readMesh(path("a.stl")).triangles.size());
  EXPECT_LE(stats["deviation"], stats["tolerance"]);
  EXPECT_EQ(stats["options"], Json({{"tolerance", nullptr}, {"triangles", 300}}));
  EXPECT_EQ(Json::parse(succeed("simplify a.stl --triangles 300 -o b.ply --json -q").out)["tolerance"],
            stats["tolerance"]);
}

TEST_F(CliSimplify, KeepsToATolerance) {
  writeTorus();
  succeed("simplify torus.ply --tolerance 0.01 -o a.ply --stats a.json --threads 1");
  const Json stats = json("a.json");
  EXPECT_EQ(stats["tolerance"], 0.01);
  EXPECT_GT(stats["deviation"], 0.0);
  EXPECT_LE(stats["deviation"], 0.01);
  EXPECT_LT(stats["triangles_after"], 1800);
  const Result limited = run("simplify torus.ply --tolerance 0.01 --triangles 20 -o b.ply");
  EXPECT_EQ(limited.code, 0);
  EXPECT_NE(
      limited.err.find("triangles are left instead of 20: no fewer were found within the tolerance of 0.01"),
      std::string::npos)
      << limited.err;
  EXPECT_GT(readMesh(path("b.ply")).triangles.size(), 20u);
  EXPECT_NE(
      succeed("simplify torus.ply --tolerance 0 -o c.ply").out.find("kept as it is, with 1,920 triangles"),
      std::string::npos);
  // In inches, as all lengths.
  succeed("simplify torus.ply --from mm --to in --tolerance 0.01 -o d.ply --stats d.json");
  EXPECT_NEAR(bounds(readMesh(path("d.ply"))).size().x, 5.4 / 25.4, 0.01);
  EXPECT_LT(json("d.json")["triangles_after"], stats["triangles_after"]);
}

TEST_F(CliSimplify, RefusesWhatMakesNoSense) {
  writeTorus();
  expectFailure("simplify torus.ply -o a.ply", ErrorCode::Usage,
                "add --triangles N, --tolerance LENGTH or both");
  expectFailure("simplify torus.ply -o a.ply --triangles 0", ErrorCode::Usage, "--triangles");
  for (const char* command : {"simplify", "mesh", "repair"})
    expectFailure(std::string(command) + " torus.ply -o a.ply --triangles 500 --tolerance 0",
                  ErrorCode::Usage, "--tolerance 0 keeps all triangles, so --triangles cannot limit them");
  expectFailure("simplify torus.ply -o torus.ply --triangles 500", ErrorCode::Usage, "--overwrite");
  Mesh torn = readMesh(path("torus.ply"));
  torn.triangles.pop_back();
  writeMesh(path("torn.ply"), torn);
  expectFailure("simplify torn.ply -o a.ply --triangles 500", ErrorCode::Input, "repair the mesh first");
  EXPECT_FALSE(fs::exists(path("a.ply")));
}

TEST_F(CliSimplify, IsPartOfMeshAndRepair) {
  writeTorus();
  succeed("mesh torus.ply -o a.ply --resolution 48 --triangles 600 --stats a.json");
  EXPECT_LE(json("a.json")["triangles"], 600);
  EXPECT_GE(json("a.json")["triangles"], 540);
  const std::string kept = succeed("repair torus.ply -o b.ply --triangles 600 --stats b.json").out;
  EXPECT_NE(kept.find("its own faces are simplified"), std::string::npos) << kept;
  EXPECT_LE(json("b.json")["after"]["triangles"], 600);
  EXPECT_EQ(json("b.json")["options"]["triangles"], 600);
  const std::string made = succeed("repair torus.ply -o c.ply --resolution 48 --remesh --triangles 600").out;
  EXPECT_TRUE(std::regex_search(
      made, std::regex("simplified +from [0-9,]+ triangles, at most 0.0[0-9]+ off them, with a tolerance")))
      << made;
  EXPECT_LE(readMesh(path("c.ply")).triangles.size(), 600u);
}

}  // namespace
}  // namespace raymap
