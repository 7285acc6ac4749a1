#include <regex>

#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliMesh : public Cli {};

TEST_F(CliMesh, MakesAClosedMesh) {
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
  succeed("mesh torn.ply -o direct.ply --resolution 40 --no-close-holes");
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

TEST_F(CliMesh, RefusesAFormatThatBreaksTheResult) {
  writeMesh(path("far.obj"), shapes::box({5e5, 5.5e6, 300.0}, {5e5 + 10.0, 5.5e6 + 8.0, 306.0}));
  for (const char* command : {"repair", "mesh"}) {
    const std::string run = std::string(command) + " far.obj --overwrite --resolution 40 " +
                            (std::string(command) == "repair" ? "--remesh " : "") + "--tolerance 0 " +
                            "-o far";
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
    EXPECT_EQ(succeed(run + ".ply").out.find("recentered"), std::string::npos);
    EXPECT_NEAR(diagnose(readMesh(path("far.ply"))).bounds.min.y, 5.5e6, 0.01);
  }
  succeed("repair far.obj --resolution 64 --remesh -o far.ply --recenter --stats far.json");
  EXPECT_EQ(json("far.json")["file_offset"], Json({500005.0, 5500004.0, 303.0}));
  EXPECT_LT(json("far.json")["mesh_from_result"]["max"], 0.02);
}

TEST_F(CliMesh, WarnsThatAFormatMovesTheMesh) {
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
                   "write one of .ply .obj .glb .3mf, or move the mesh closer \\(--recenter\\)\n$")))
        << moved.err;
    const std::string text = succeed(command + "near.stl --recenter --overwrite").out;
    EXPECT_NE(text.find("recentered: add 5e+06 4e+06 100 to the positions"), std::string::npos) << text;
    EXPECT_LT(glm::length(bounds(readMesh(path("near.stl"))).centre()), 0.1);
  }
}

TEST_F(CliMesh, MeasuresTheMeshAsStored) {
  // Steps of 2^-6 are small enough to keep the box whole, but larger than the result's other deviations.
  writeMesh(path("far.obj"), shapes::box({2e5, 0.0, 0.0}, {2e5 + 10.003, 8.0, 6.0}));
  const auto deviation = [&](const std::string& file) {
    EXPECT_EQ(run("repair far.obj --resolution 64 --remesh --tolerance 0 --stats s.json -o " + file).code, 0);
    return json("s.json")["result_from_mesh"]["mean"].get<double>();
  };
  EXPECT_GT(deviation("far.stl"), 2.0 * deviation("far.ply"));
  EXPECT_LT(deviation("far.stl --recenter"), 1.01 * deviation("far.ply"));
}

}  // namespace
}  // namespace raymap
