#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "cli.h"
#include "fill.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliInfo : public Cli {};

TEST_F(CliInfo, WritesTheExampleMesh) {
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

TEST_F(CliInfo, LeavesOutCrossingPairsOnRequest) {
  writeMesh(path("two.ply"), shapes::joined(shapes::torus(2.0, 0.7, 40, 24), shapes::sphere(1.5, 3)));
  EXPECT_NE(succeed("info two.ply --fast").out.find("\ncrossing pairs of faces  not counted (--fast)\n"),
            std::string::npos);
  Json fast = Json::parse(succeed("info two.ply --fast --json").out);
  Json full = Json::parse(succeed("info two.ply --json").out);
  EXPECT_TRUE(fast["self_intersections"].is_null());
  EXPECT_GT(full["self_intersections"]["pairs"], 100);
  EXPECT_EQ(fast["verdict"]["kind"], "several_solids");
  EXPECT_EQ(full["verdict"]["kind"], "overlapping_solids");
  for (const char* key : {"self_intersections", "verdict"}) {
    fast.erase(key);
    full.erase(key);
  }
  EXPECT_EQ(fast, full);
  expectFailure("info two.ply --fast --picture two.png", ErrorCode::Usage, "leave out --fast");
}

TEST_F(CliInfo, EndsInformationWithAVerdict) {
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
  EXPECT_EQ(slab(0.04),
            "This is a clean solid, with nothing wrong.\nIts thinnest part is about 0.04 thick. A repair "
            "chooses what keeps it, --voxel-size 0.02: 600 x 600 x 102 samples.\n");
  EXPECT_EQ(slab(0.001),
            "This is a clean solid, with nothing wrong.\nIts thinnest part is about 0.001 thick. To "
            "keep it as it is would take --voxel-size 0.0005: 24,000 x 24,000 x 4,002 samples. A repair "
            "that must make new faces takes 256 samples, and makes what is thinner 0.082 thick.\n");
  EXPECT_EQ(verdict(two, " --fast"),
            "This is 2 clean, separate solids, with nothing wrong. Faces that cross and parts that overlap "
            "were not looked for (--fast).\n");
  Mesh torn = torus;
  torn.triangles.pop_back();
  std::swap(torn.triangles[9].x, torn.triangles[9].y);
  EXPECT_TRUE(verdict(torn, "").starts_with(
      "This is a solid with holes, as scans have: 1 hole, 0.507 wide. It also has "))
      << verdict(torn, "");
  EXPECT_NE(verdict(torn, "").find("It also has 1 reversed face.\n"), std::string::npos);
  Mesh square;
  square.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::string sheet = verdict(square, "");
  const size_t command = sheet.find("raymap mesh ");
  ASSERT_NE(command, std::string::npos) << sheet;
  EXPECT_EQ(sheet.substr(command),
            "raymap mesh 'a mesh.ply' -o 'a mesh.solid.ply' --thickness 0.2 --voxel-size 0.05\n");
  EXPECT_NE(sheet.find("raymap repair 'a mesh.ply' -o 'a mesh.solid.ply' --base Z\n"), std::string::npos);
  succeed(sheet.substr(command + 7, sheet.size() - command - 8) + " --device cpu");
  EXPECT_NEAR(diagnose(readMesh(path("a mesh.solid.ply"))).signedVolume, 20.0, 2.0);
}

TEST_F(CliInfo, NamesTheGridThatARepairTakes) {
  writeMesh(path("soup.ply"), shapes::joined(shapes::soup(30, 1), shapes::box({0, 0, 0}, {0.5, 0.5, 0.002})));
  const std::string text = succeed("info soup.ply").out;
  ASSERT_NE(text.find("a soup of faces"), std::string::npos) << text;
  const RepairGrid grid = fitRepairGrid(readMesh(path("soup.ply")));
  EXPECT_EQ(std::max({grid.dims.x, grid.dims.y, grid.dims.z}), 128);
  std::array<char, 120> said{};
  std::snprintf(said.data(), said.size(),
                "A repair that must make new faces takes 128 samples, and makes what is thinner %.3g thick.",
                1.75 * grid.spacing);
  EXPECT_NE(text.find(said.data()), std::string::npos) << text << said.data();
}

TEST_F(CliInfo, TellsTheUnit) {
  writeMesh(path("box.3mf"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)), {.unit = LengthUnit::Inch});
  const Result inch = run("info box.3mf");
  EXPECT_NE(inch.out.find("unit                     mm\n"), std::string::npos) << inch.out;
  EXPECT_EQ(inch.err,
            "raymap: warning: box.3mf: 3D/3dmodel.model is in the unit inch; converted to millimetres\n");
  EXPECT_EQ(Json::parse(run("info box.3mf --json").out)["unit"], "mm");
}

TEST_F(CliInfo, ReportsFields) {
  Field field;
  field.grid = {{3, 1, 1}, {1, 2, 3}, 0.5};
  fill(field.distance, std::vector(3, 0.25F));
  field.distance[0] = -0.75F;
  field.distance[2] = NAN;
  fill(field.winding, std::vector(3, 1.0F));
  field.clampDistance = 1.5;
  field.surfaceBounds = {{0, 1, 2}, {3, 4, 5}};
  writeField(path("f.npz"), field);
  const std::string text = succeed("info f.npz").out;
  for (const char* line :
       {"samples                  3 x 1 x 1 = 3\n", "first sample (origin)    1 2 3\n",
        "last sample              2 2 3\n", "spacing                  0.5\n",
        "arrays                   distance, winding\n",
        "surface, lowest          0 1 2\nsurface, highest         3 4 5\n",
        "distances clamped to     1.5, 3 samples\n", "distances                -0.75 to 0.25\n",
        "samples inside           1, 33.33 %\n", "values not finite        1\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  const Json found = Json::parse(succeed("info f.npz --json --from in --to mm").out);
  EXPECT_EQ(found["grid"]["origin"], Json({25.4, 50.8, 25.4 * 3}));
  EXPECT_EQ(found["unit"], "mm");
  EXPECT_EQ(found["arrays"], Json({"distance", "winding"}));
  EXPECT_EQ(found["clamp_distance"], 1.5 * 25.4);
  EXPECT_EQ(found["surface_bounds"][1][2], 127.0);
  EXPECT_EQ(found["inside"], 1);
  EXPECT_EQ(found["non_finite"], 1);
  EXPECT_NEAR(found["min"].get<double>(), -0.75 * 25.4, 1e-5);
}

TEST_F(CliInfo, DrawsFields) {
  writeTorus();
  succeed("generate torus.ply -o t.npz --resolution 24 --winding w.npz");
  succeed("info t.npz --picture t.png --size 64 48");
  succeed("render t.npz -o same.png --size 64 48 --device cpu");
  EXPECT_EQ(readBytes(path("t.png")), readBytes(path("same.png")));
  const std::string text = succeed("info w.npz --picture w.png --size 64 48").out;
  EXPECT_NE(text.find("winding numbers          "), std::string::npos) << text;
  EXPECT_EQ(text.find("samples inside"), std::string::npos) << text;
  succeed("render w.npz -o slice.png --slice z --size 64 48");
  EXPECT_EQ(readBytes(path("w.png")), readBytes(path("slice.png")));
  EXPECT_TRUE(Json::parse(succeed("info w.npz --json").out)["inside"].is_null());
}

TEST_F(CliInfo, ListsSeveralFiles) {
  writeTorus();
  writeMesh(path("two.ply"), shapes::joined(shapes::sphere(1.0, 1), shapes::box({2, 2, 2}, {3, 3, 3})));
  succeed("generate torus.ply -o t.npz --resolution 24");
  std::ofstream(path("broken.ply")) << "ply\nformat ascii 1.0\n";
  const Result found = run("info torus.ply two.ply broken.ply t.npz");
  EXPECT_NE(found.code, 0);
  EXPECT_NE(found.err.find("broken.ply"), std::string::npos);
  EXPECT_EQ(std::ranges::count(found.out, '\n'), 5) << found.out;
  EXPECT_NE(found.out.find("\ntwo.ply     yes "), std::string::npos) << found.out;
  EXPECT_NE(found.out.find("\nbroken.ply  - "), std::string::npos) << found.out;
  const Json all = Json::parse(succeed("info torus.ply two.ply t.npz --json --fast").out);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1]["components"], 2);
  EXPECT_EQ(all[1]["file"], "two.ply");
  EXPECT_TRUE(all[2].contains("grid"));
  expectFailure("info torus.ply two.ply --picture x.png", ErrorCode::Usage, "--picture shows one file");
}

}  // namespace
}  // namespace raymap
