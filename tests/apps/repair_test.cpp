#include <cmath>
#include <vector>

#include "cli.h"
#include "shapes.h"
#include "textured_glb.h"

namespace raymap {
namespace {

class CliRepair : public Cli {};

TEST_F(CliRepair, NamesTheFlagThatKeepsWhatIsLost) {
  writeMesh(path("plate.ply"),
            shapes::joined(shapes::box({0, 0, 0}, {10, 10, 10}), shapes::box({1, 4.03, 9}, {9, 4.33, 16})));
  const std::string text = run("repair plate.ply -o plate.stl --remesh --voxel-size 0.5 --min-thickness 0 "
                               "--device cpu --stats plate.json")
                               .err;
  const Json warning = json("plate.json")["warnings"].at(0);
  EXPECT_EQ(warning["code"], "solid_lost");
  EXPECT_EQ(warning["voxel_size"], json("plate.json")["loss"]["voxel_size"]);
  EXPECT_EQ(warning["message"].get<std::string>().find("--"), std::string::npos);
  const std::string flag = " (--voxel-size " + warning["voxel_size"].dump() + ")\n";
  EXPECT_EQ(text, "raymap: warning: " + warning["message"].get<std::string>() + flag);
}

TEST_F(CliRepair, KeepsAttributesOfFacesThatStay) {
  std::ofstream(path("two.obj")) << "mtllib two.mtl\no one\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                    "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 3/3 4/2\n"
                                    "o two\nusemtl blue\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\n"
                                    "f 5/1 7/2 6/3\nf 5/1 6/2 8/3\nf 5/1 8/3 7/2\nf 6/1 7/2 8/3\n";
  fs::create_directory(path("out"));
  succeed("repair two.obj -o out/two.obj");  // One face is turned, one is added.
  const std::string text = readBytes(path("out/two.obj"));
  EXPECT_NE(text.find("mtllib ../two.mtl\n"), std::string::npos) << text;
  EXPECT_NE(text.find("o one\nusemtl red\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\no two\nusemtl blue\n"),
            std::string::npos)
      << text;
  EXPECT_TRUE(text.ends_with("f 6/1 7/2 8/3\no added\nusemtl added\nf 2 3 4\n")) << text;
  const auto warningOf = [&](const std::string& arguments) {
    const Result result = runQuietly(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(warningOf("repair two.obj -o two.3mf"),
            "raymap: warning: two.3mf: it lacks what the given mesh has: texture coordinates and looks of "
            "materials; an .obj keeps texture coordinates\n");
  const std::string all =
      ": it lacks what the given mesh has: 2 part names, 2 materials and texture coordinates";
  EXPECT_EQ(warningOf("repair two.obj -o two.stl"),
            "raymap: warning: two.stl" + all + "; an .obj keeps them\n");
  EXPECT_EQ(warningOf("repair two.obj -o field.obj --remesh --resolution 32 --device cpu"),
            "raymap: warning: field.obj" + all + "\n");
  EXPECT_EQ(
      warningOf("convert two.obj -o part.stl --split"),
      "raymap: warning: part_1.stl: it lacks what the given mesh has: 1 material and texture coordinates; an "
      ".obj keeps them\n");
  EXPECT_EQ(warningOf("convert two.3mf again.obj"),
            "raymap: warning: again.obj: it lacks what the given mesh has: looks of materials\n");
  EXPECT_NE(readBytes(path("again.obj")).find("o two\nusemtl blue\n"), std::string::npos);
}

TEST_F(CliRepair, KeepsTexturesOfAGlb) {
  std::string buffer;
  const std::string json = samples::texturedJson(buffer);
  std::ofstream(path("in.glb"), std::ios::binary) << samples::glb(json, buffer);
  for (const std::string command : {"convert", "repair"}) {
    EXPECT_NE(run(command + " in.glb -o " + command + ".glb")
                  .err.find("lacks what the given mesh has: 1 texture with other coordinates\n"),
              std::string::npos);
    const std::string text = readBytes(path(command + ".glb"));
    for (const std::string& kept : {samples::kImage, std::string("TEXCOORD_0"), std::string("COLOR_0")})
      EXPECT_NE(text.find(kept), std::string::npos) << command << " " << kept;
  }
}

TEST_F(CliRepair, RepairsAMesh) {
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
  EXPECT_EQ(solid["closed_holes"], 1);
  EXPECT_EQ(solid["stats"]["patch_triangles"], 0);
  succeed("repair torn.ply -o grown.ply --resolution 64 --offset 0.15 --stats grown.json");
  const double ratio = json("grown.json")["after"]["signed_volume"].get<double>() /
                       solid["after"]["signed_volume"].get<double>();
  EXPECT_NEAR(ratio, 0.85 * 0.85 / 0.49, 0.01);
  EXPECT_LT(json("grown.json")["result_from_mesh"]["p99"], 0.2 * spacing);
  expectFailure("repair torn.ply -o none.ply --resolution 64 --offset -1", ErrorCode::Input,
                "the mesh encloses no volume at this resolution");
  const std::string filled = succeed("repair torn.ply -o filled.ply --stats filled.json").out;
  EXPECT_NE(filled.find("\nclosed 1 hole with 1 face, all other faces kept as they are"), std::string::npos)
      << filled;
  EXPECT_EQ(json("filled.json")["closed_holes"], 1);
  EXPECT_EQ(json("filled.json")["closing_faces"], 1);
  EXPECT_EQ(json("filled.json")["after"]["triangles"], 4800);
}

TEST_F(CliRepair, KeepsAMeshThatIsRight) {
  const Mesh ball = shapes::sphere(1.0, 4);
  writeMesh(path("ball.stl"), ball);
  const std::string text = succeed("repair ball.stl -o kept.stl --stats kept.json").out;
  EXPECT_NE(text.find("\nkept as it is, because nothing is wrong with it; --remesh makes new faces\n"
                      "result: 5,120 triangles, 1 solid, 0 cavities, checked as stored: watertight"),
            std::string::npos)
      << text;
  EXPECT_EQ(readBytes(path("kept.stl")), readBytes(path("ball.stl")));
  EXPECT_EQ(json("kept.json")["depth"], "as_given");
  EXPECT_EQ(json("kept.json")["solids"], 1);
  EXPECT_EQ(json("kept.json")["stats"]["stages"].at(0).at("name"), "inspect");
  succeed("repair ball.stl -o made.stl --remesh --resolution 32 --stats made.json");
  EXPECT_EQ(json("made.json")["depth"], "field");
  EXPECT_EQ(json("made.json")["field_reason"], "asked");
  EXPECT_NE(json("made.json")["after"]["triangles"], 5120);
  writeMesh(path("two.ply"), shapes::joined(ball, shapes::sphere(0.5, 3)));
  const std::string overlap = succeed("repair two.ply -o one.ply --resolution 32 --stats one.json").out;
  EXPECT_NE(overlap.find("\n  parts of it face the wrong way: solids in solids"), std::string::npos)
      << overlap;
  EXPECT_EQ(json("one.json")["parts_overlap"], true);
}

TEST_F(CliRepair, LeavesHolesAndFacesAsTheyAreOnRequest) {
  Mesh mesh = shapes::torus(2.0, 0.7, 60, 40);
  for (size_t f = 0; f < mesh.triangles.size(); f += 5) turnFaces(mesh, std::vector<uint32_t>{uint32_t(f)});
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.65; });
  writeMesh(path("torn.ply"), mesh);
  EXPECT_EQ(run("repair torn.ply -o turned.stl --resolution 48 --stats turned.json").code, 0);
  const Json turned = json("turned.json");
  EXPECT_GT(turned["stats"]["turned_faces"], mesh.triangles.size() / 6);
  EXPECT_EQ(turned["depth"], "mended");
  run("repair torn.ply -o kept.stl --resolution 48 --orientation keep --no-close-holes --stats kept.json");
  const Json kept = json("kept.json");
  EXPECT_EQ(kept["stats"]["turned_faces"], 0);
  EXPECT_EQ(kept["stats"]["patch_triangles"], 0);
  EXPECT_TRUE(kept["after"]["watertight"]);
}

TEST_F(CliRepair, DropsCrumbsAndFillsBubbles) {
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
  EXPECT_GT(ball["buried"]["volume"], 0.0);
  EXPECT_NE(dropped.out.find("1 part, volume 0.002"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.out.find("; below 0.01\n"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.out.find("1 cavity, volume 0.5"), std::string::npos) << dropped.out;
  EXPECT_NE(dropped.err.find("warning: filled 1 sealed cavity"), std::string::npos) << dropped.err;
  EXPECT_NE(dropped.err.find("cavities can be kept (--keep-cavities)\n"), std::string::npos) << dropped.err;
  EXPECT_EQ(ball["warnings"][0]["code"], "cavities_filled");
  EXPECT_EQ(ball["warnings"][0]["count"], 1);
  EXPECT_EQ(ball["warnings"][0]["volume"], ball["filled"]["largest"]);
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

TEST_F(CliRepair, ThickensThinParts) {
  const Mesh fin = shapes::joined(shapes::box({0, 0, 0}, {4, 4, 4}), shapes::box({1, 1.95, 3}, {3, 2.05, 7}));
  writeMesh(path("fin.ply"), fin);
  const std::string text =
      succeed("repair fin.ply -o fin.stl --voxel-size 0.2 --min-thickness 0.5 --stats fin.json").out;
  EXPECT_NE(text.find("of the mesh's area was thinner than 0.5"), std::string::npos) << text;
  const Json stats = json("fin.json");
  EXPECT_EQ(stats["options"]["min_thickness"], 0.5);
  EXPECT_NEAR(stats["thickened_share"].get<double>(), 12.0 / 113.2, 0.01);
  expectFailure("repair fin.ply -o none.stl --voxel-size 0.4 --min-thickness 0.5", ErrorCode::Usage,
                "use a voxel size of at most 0.25");
}

/// A wavy sheet over n x n squares.
Mesh terrain(int n) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) p.emplace_back(i, j, 0.25 * ((3 * i + 5 * j) % 7));
  const auto at = [&](int i, int j) { return uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      t.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      t.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return makeMesh(p, t);
}

TEST_F(CliRepair, SaysWhatToMakeOfASheet) {
  writeMesh(path("terrain.stl"), terrain(10));
  const std::string info = succeed("info terrain.stl").out;
  const std::string command =
      "raymap mesh terrain.stl -o terrain.solid.stl --thickness 0.2 --voxel-size 0.05";
  EXPECT_NE(info.find(command + "\n"), std::string::npos) << info;
  const Result guess = run("repair terrain.stl -o guess.stl --resolution 24 --stats guess.json");
  EXPECT_EQ(guess.code, 0);
  EXPECT_NE(guess.err.find("the mesh is a sheet"), std::string::npos) << guess.err;
  EXPECT_NE(guess.err.find(" (" + command + "; or --base Z)\n"), std::string::npos) << guess.err;
  EXPECT_EQ(json("guess.json")["warnings"][0]["code"], "sheet");
  const Result block = run("repair terrain.stl -o block.stl --base -3 --down 0 0 -1 --stats block.json");
  EXPECT_EQ(block.code, 0);
  EXPECT_EQ(block.err, "");
  EXPECT_NE(block.out.find("\njoined the rim to a base at -3 with "), std::string::npos) << block.out;
  EXPECT_EQ(json("block.json")["options"]["base"], -3.0);
  EXPECT_EQ(json("block.json")["depth"], "mended");
  EXPECT_EQ(bounds(readMesh(path("block.stl"))).min.z, -3.0);
  succeed("check block.stl");
  expectFailure("repair terrain.stl -o block.stl --base 1", ErrorCode::Input, "use one of at most 0");
  expectFailure("mesh terrain.stl -o block.stl --base 1", ErrorCode::Usage,
                "raymap repair MESH -o RESULT --base Z");
}

TEST_F(CliRepair, TurnsACertainFaceBack) {
  Mesh mesh =
      shapes::joined(shapes::box({0, 0, 0}, {9, 9, 9}), shapes::inverted(shapes::box({3, 3, 3}, {6, 6, 6})));
  std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
  mesh.triangles.erase(mesh.triangles.begin() + 8);
  writeMesh(path("turned.ply"), mesh);
  const std::string text = succeed("repair turned.ply -o kept.ply --stats kept.json").out;
  EXPECT_NE(text.find("\nreversed 1 face, closed 1 hole with 1 face, all other faces kept as they are; "
                      "--remesh makes all faces from the field\nresult: 24 triangles, 1 solid, 1 cavity, "),
            std::string::npos)
      << text;
  EXPECT_EQ(json("kept.json")["stats"]["turned_faces"], 1);
}

TEST_F(CliRepair, AsksForTheUnitOfLengthsBeyondTheMesh) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1, 2, 4)));
  const std::string asks =
      " is more than the longest side of the whole shape, 4; is the unit right? (--from U --to V converts "
      "what "
      "is read)\n";
  const auto warnings = [&](const std::string& command) {
    return runQuietly(command + " -q --resolution 12").err;
  };
  for (const std::string option : {"--shell", "--offset", "--min-thickness"}) {
    const std::string asked = warnings("repair box.ply -o r.ply " + option + " 4.5");
    EXPECT_EQ(asked.rfind("raymap: warning: " + option + " 4.5" + asks, 0), 0u) << asked;
    const std::string fits = warnings("repair box.ply -o r.ply " + option + " 4");
    EXPECT_EQ(fits.find("is the unit right"), std::string::npos) << fits;
  }
  EXPECT_NE(warnings("repair box.ply -o r.ply --shell 0.8 --drain-hole 5").find("--drain-hole 5" + asks),
            std::string::npos);
  EXPECT_NE(warnings("repair box.ply -o r.ply --remesh --offset -5").find("--offset 5" + asks),
            std::string::npos);
  for (const std::string command : {"generate box.ply -o f.nrrd", "render box.ply -o r.png --size 9 9"})
    EXPECT_EQ(warnings(command + " --device cpu --thickness 5"), "raymap: warning: --thickness 5" + asks);
  EXPECT_EQ(warnings("generate box.ply -o f.nrrd --device cpu --thickness 4"), "");
  for (const std::string command : {"r.png --size 9 9", "r.html"})
    EXPECT_EQ(warnings("render box.ply --device cpu --shell 5 -o " + command),
              "raymap: warning: --shell 5" + asks);
}

TEST_F(CliRepair, NamesOtherFormatsThatHoldTheResult) {
  Mesh mesh = shapes::joined(shapes::box({-10, -10, 0}, {10, 10, 1}),
                             shapes::box({-2.69, -2.23, 1.0005}, {3.31, 3.77, 2}));
  for (glm::vec3& v : mesh.vertices) v.z += 0.137f * v.x + 0.213f * v.y;
  mesh.origin = {5e4, 7e4, 3e4};
  writeMesh(path("slant.obj"), mesh);
  succeed("check slant.obj");
  expectFailure("repair slant.obj -o slant.stl", ErrorCode::Unsupported,
                " of faces cross instead of 0; write a .ply, .obj, .glb or .3mf, or add --recenter\n");
  expectFailure("repair slant.obj -o far --format STL", ErrorCode::Unsupported,
                " of faces cross instead of 0; write a .ply, .obj, .glb or .3mf, or add --recenter\n");
  succeed("repair slant.obj -o slant.ply");
}

TEST_F(CliRepair, HollowsAMeshOut) {
  writeMesh(path("ball.ply"), shapes::sphere(1.0, 4));
  succeed("repair ball.ply -o ball.stl --resolution 64 --shell 0.2 --stats ball.json");
  const Json ball = json("ball.json");
  EXPECT_EQ(ball["hollows"], 1);
  EXPECT_EQ(ball["after"]["components"], 2);
  succeed("repair ball.ply -o drained.stl --resolution 64 --shell 0.2 --drain-hole 0.3 --stats drained.json");
  const Json drained = json("drained.json");
  EXPECT_EQ(drained["drain_holes"], 1);
  EXPECT_EQ(drained["after"]["components"], 1);
  expectFailure("repair ball.ply -o thin.stl --resolution 64 --shell 0.01", ErrorCode::Usage,
                "thinner than two samples");
  expectFailure("repair ball.ply -o thin.stl --drain-hole 0.3", ErrorCode::Usage,
                "--drain-hole needs --shell LENGTH; add it");
}

TEST_F(CliRepair, DrillsVents) {
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
  expectFailure(repair + "--drain-holes 2", ErrorCode::Usage,
                "--drain-holes needs --drain-hole LENGTH; add it");
  expectFailure(repair + "--down 0 0 -1", ErrorCode::Usage,
                "--down needs --base Z or --drain-hole LENGTH; add it");
}

TEST_F(CliRepair, RepairsInUnitsAndAxes) {
  writeMesh(path("ball.glb"), shapes::sphere(1.0, 4));
  succeed("repair ball.glb -o ball.3mf --unit mm --up y --resolution 20 --stats s.json");
  EXPECT_NEAR(bounds(readMesh(path("ball.3mf"))).max.z, 1000, 10);
  const Json options = json("s.json")["options"];
  EXPECT_EQ(options["unit"], "mm");
  EXPECT_EQ(options["scale"], 1.0);
  EXPECT_EQ(options["up"], Json({0.0, 1.0, 0.0}));
  succeed("repair ball.glb -o plain.glb --resolution 20 --stats t.json");
  EXPECT_EQ(json("t.json")["options"]["unit"], "m");
  EXPECT_TRUE(json("t.json")["options"]["up"].is_null());
}

TEST_F(CliRepair, DrillsDownInTheAxesOfTheResult) {
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
  // Without --up, what is up in the input is up in the result.
  succeed("convert ball.ply -o ball.glb");
  const std::string hollow = "repair ball.glb -o e.glb --resolution 40 --shell .15 --drain-hole .25";
  EXPECT_NE(succeed(hollow).out.find("\ndown is -y, as the format has it; --up"), std::string::npos);
  const std::string guessed = readBytes(path("e.glb"));
  succeed(hollow + " --down 0 -1 0");
  EXPECT_EQ(readBytes(path("e.glb")), guessed);
  EXPECT_NE(succeed("info ball.glb").out.find("\nup                       y, as in every .glb\n"),
            std::string::npos);
}

TEST_F(CliRepair, CutsFlatAndWritesBothHalves) {
  writeMesh(path("box.ply"), shapes::box({0, 0, 0}, {2, 3, 4}));
  EXPECT_NE(succeed("repair box.ply -o low.stl --cut-plane 0 0 1 1.5").out.find("--split"),
            std::string::npos);
  EXPECT_EQ(diagnose(readMesh(path("low.stl"))).signedVolume, 9.0);
  succeed("repair box.ply -o half.stl --cut-plane 0 0 1 1.5 --split --recenter --stats t.json");
  EXPECT_EQ(readBytes(path("half_1.stl")).size(), readBytes(path("low.stl")).size());
  const Json parts = json("t.json")["parts"];
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0]["volume"], 9.0);
  EXPECT_EQ(parts[1]["volume"], 15.0);
  EXPECT_EQ(parts[1]["size"], Json({2.0, 3.0, 2.5}));
  expectFailure("repair half_1.stl -o half.stl --split", ErrorCode::Usage, "half_1.stl: is the input");
  expectFailure("repair box.ply -o a.stl --cut-plane 0 0 1 5", ErrorCode::Input,
                "misses the solid, which reaches from 0 to 4");
  expectFailure("repair box.ply -o - --format stl --split", ErrorCode::Usage,
                "--split writes a file for each part");
}

}  // namespace
}  // namespace raymap
