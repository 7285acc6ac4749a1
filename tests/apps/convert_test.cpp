#include <algorithm>

#include "bands.h"
#include "cli.h"
#include "fill.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliConvert : public Cli {};

TEST_F(CliConvert, ConvertsMeshes) {
  writeTorus();
  succeed("convert torus.ply torus.glb");
  const Mesh before = readMesh(path("torus.ply")), after = readMesh(path("torus.glb"));
  EXPECT_EQ(before.vertices, after.vertices);
  EXPECT_EQ(before.triangles, after.triangles);
  expectFailure("convert torus.ply torus.vdb", ErrorCode::Usage, "torus.vdb");
  succeed("convert torus.ply -o again.ply");
  EXPECT_EQ(readBytes(path("again.ply")), readBytes(path("torus.ply")));
  expectFailure("convert torus.ply -o torus.vdb", ErrorCode::Usage, "torus.vdb");
  expectFailure("convert torus.ply", ErrorCode::Usage, "--output is required");
  expectFailure("convert torus.ply a.ply -o b.ply", ErrorCode::Usage, "b.ply is none; give one input");
}

TEST_F(CliConvert, SplitsIntoParts) {
  const Mesh hollow = shapes::joined(shapes::sphere(2.0, 2), shapes::inverted(shapes::sphere(1.5, 2)));
  const Mesh all =
      shapes::joined(shapes::joined(hollow, shapes::sphere(0.5, 1)), shapes::box({5, 0, 0}, {6, 1, 1}));
  writeMesh(path("plate.ply"), all);
  const std::string out = succeed("convert plate.ply -o part.ply --split").out;
  EXPECT_FALSE(fs::exists(path("part.ply")));
  const Mesh first = readMesh(path("part_1.ply")), third = readMesh(path("part_3.ply"));
  EXPECT_EQ(first.triangles.size(), hollow.triangles.size());  // With its cavity, without the ball in that.
  EXPECT_NEAR(diagnose(first).signedVolume, diagnose(hollow).signedVolume, 1e-5);
  EXPECT_NEAR(diagnose(readMesh(path("part_2.ply"))).signedVolume,
              diagnose(shapes::sphere(0.5, 1)).signedVolume, 1e-5);
  EXPECT_EQ(bounds(third).max.x, 6.0);
  EXPECT_EQ(third.vertices.size(), 8u);
  EXPECT_FALSE(fs::exists(path("part_4.ply")));
  expectFailure("convert plate.ply -o - --format ply --split", ErrorCode::Usage,
                "--split writes a file for each part");
}

TEST_F(CliConvert, ConvertsUnitsScaleAndAxis) {
  // y is up: 2 wide, 3 high, 5 deep.
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(2, 3, 5)));
  const auto expectBox = [&](const std::string& arguments, const glm::dvec3& low, const glm::dvec3& high) {
    succeed("convert " + arguments);
    const std::string name = arguments.substr(arguments.find(' ') + 1);
    const Mesh mesh = readMesh(path(name.substr(0, name.find(' '))));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(bounds(mesh).min[axis], low[axis], 1e-4) << arguments << " " << axis;
      EXPECT_NEAR(bounds(mesh).max[axis], high[axis], 1e-4) << arguments << " " << axis;
    }
    EXPECT_GT(diagnose(mesh).signedVolume, 0.0) << arguments;
  };
  expectBox("box.ply a.3mf", {0, 0, 0}, {2, 3, 5});
  expectBox("box.ply inch.3mf --unit in", {0, 0, 0}, {50.8, 76.2, 127});
  expectBox("box.ply scaled.ply --scale 2.5 --unit in", {0, 0, 0}, {5, 7.5, 12.5});
  expectBox("box.ply z.ply --up y", {0, -5, 0}, {2, 0, 3});
  expectBox("z.ply y.glb --up z --unit m", {0, 0, 0}, {2, 3, 5});
  expectBox("y.glb y2.glb --up y", {0, 0, 0}, {2, 3, 5});
  expectBox("y.glb metres.3mf --scale .001", {0, 0, 0}, {2, 3, 5});
  expectBox("y.glb b.stl --unit cm --scale 2 --up y", {0, -1000, 0}, {400, 0, 600});
  EXPECT_EQ(
      run("convert y.glb c.stl").err,
      "raymap: warning: c.stl: its lengths are in m, as in y.glb, but programs take them for mm; --unit mm "
      "converts them\n");
  EXPECT_EQ(
      run("convert a.3mf c.glb").err,
      "raymap: warning: c.glb: its lengths are in mm, as in a.3mf, but programs take them for m; --unit m "
      "converts them\n");
}

TEST_F(CliConvert, ScalesToAHeightOrIntoABox) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(1.0), glm::dvec3(3, 4, 6)));  // 2 x 3 x 5.
  const auto expectSize = [&](const std::string& arguments, const glm::dvec3& size, const std::string& said) {
    const std::string text = succeed("convert box.ply " + arguments).out;
    EXPECT_NE(("\n" + text).find("\nscaled by " + said + "\n"), std::string::npos) << text;
    const Box box = bounds(readMesh(path(arguments.substr(0, arguments.find(' ')))));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(box.size()[axis], size[axis], 1e-4) << arguments;
  };
  expectSize("a.stl --height 80", {32, 48, 80}, "16 to a height of 80");
  expectSize("a.stl --height 80 --up y", {160.0 / 3, 400.0 / 3, 80}, "26.6666667 to a height of 80");
  expectSize("a.stl --height 80 --rotate 0 90 0", {200, 120, 80}, "40 to a height of 80");
  expectSize("a.glb --height 6", {4, 6, 10}, "2 to a height of 6");
  expectSize("a.glb --height 6 --up z", {2.4, 6, 3.6}, "1.2 to a height of 6");
  expectSize("a.stl --height 254 --from in --to mm", {101.6, 152.4, 254}, "2 to a height of 254");
  expectSize("a.stl --fit 4 60 60", {4, 6, 10}, "2 to fit into 4 x 60 x 60");
  expectSize("a.stl --fit 60,60,2.5", {1, 1.5, 2.5}, "0.5 to fit into 60 x 60 x 2.5");
  succeed("convert box.ply b.stl --scale 16 -q");
  succeed("convert box.ply a.stl --height 80 -q");
  EXPECT_EQ(readBytes(path("a.stl")), readBytes(path("b.stl")));
  const auto heightAlong = [&](const std::string& options, int axis) {
    const Result info = run("info box.ply --json --height 30 " + options);
    EXPECT_EQ(info.err.rfind("scaled by ", 0), 0u) << info.err;
    const Json box = Json::parse(info.out)["bounds"];
    return box[1][axis].get<double>() - box[0][axis].get<double>();
  };
  EXPECT_NEAR(heightAlong("", 2), 30.0, 1e-4);
  EXPECT_NEAR(heightAlong("--up y", 1), 30.0, 1e-4);
}

TEST_F(CliConvert, RefusesHeightsThatMeanNothing) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  writeMesh(path("sheet.ply"), makeMesh(corners, std::vector<glm::uvec3>{{0, 1, 2}}));
  expectFailure("convert sheet.ply a.stl --height 3", ErrorCode::Input,
                "sheet.ply: the mesh cannot be scaled to a height of 3: it has no extent along the axis that "
                "is up");
  succeed("convert sheet.ply a.stl --fit 3 4 5");
  EXPECT_EQ(bounds(readMesh(path("a.stl"))).size(), glm::dvec3(3, 3, 0));
  const auto usage = ErrorCode::Usage;
  expectFailure("convert sheet.ply b.stl --height 0", usage, "--height: must be a number above 0, not 0");
  expectFailure("convert sheet.ply b.stl --fit 1 -1 1", usage, "--fit: must be a number above 0, not -1");
  expectFailure("convert sheet.ply b.stl --height 3 --scale 2", usage, "cannot be used together");
  expectFailure("convert sheet.ply b.stl --height 3 --fit 1 1 1", usage, "cannot be used together");
  expectFailure("render sheet.ply sheet.ply -o b.png --height 3", usage, "leave the other out");
  writeTorus();
  succeed("generate torus.ply -o f.nrrd --resolution 12 --device cpu --fit 1 1 1");
  EXPECT_NEAR(readField(path("f.nrrd")).surfaceBounds.size().x, 1.0, 1e-5);
  expectFailure("convert f.nrrd g.nrrd --height 3", usage, "f.nrrd is a field; use --scale");
}

TEST_F(CliConvert, RefusesUnitsThatMeanNothing) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)));
  expectFailure("convert box.ply a.3mf --unit furlong", ErrorCode::Usage,
                "--unit: must be one of um, mm, cm, m, in, ft, not furlong");
  expectFailure("convert box.ply a.3mf --up w", ErrorCode::Usage,
                "--up takes 3 numbers, or an axis such as z");
  expectFailure("convert box.ply a.3mf --scale 0", ErrorCode::Usage,
                "--scale: must be a number above 0, not 0");
  expectFailure("convert box.ply a.3mf --scale 1e39", ErrorCode::Usage,
                "--scale 1e+39: the mesh becomes too large for single precision");
  expectFailure("convert box.ply a.3mf --scale 1e-39", ErrorCode::Usage,
                "--scale 1e-39: the mesh becomes too small for single precision");
  expectFailure("repair box.ply -o a.glb --unit mm", ErrorCode::Usage,
                "--unit mm: a.glb is in metres, as its format demands; use --unit m");
  Field field;
  field.grid = {{2, 2, 2}, glm::dvec3(0.0), 1.0};
  field.distance.resizeUninitialized(8);
  std::ranges::fill(field.distance, 1.0F);
  writeField(path("field.nrrd"), field);
  expectFailure("convert field.nrrd a.npz --up z", ErrorCode::Usage,
                "--up, --rotate and --recenter are for meshes, and field.nrrd is a field");
  expectFailure("convert field.nrrd a.npz --recenter", ErrorCode::Usage, "are for meshes");
  EXPECT_EQ(fileCount(), 2u);
}

TEST_F(CliConvert, SaysWhatItDropsAndWhatItDoesNotRead) {
  Field field;
  field.grid = {{2, 2, 2}, glm::dvec3(0.0), 1.0};
  fill(field.distance, std::vector(8, 1.0F));
  fill(field.winding, std::vector(8, 0.5F));
  fill(field.triangle, std::vector(8, 3U));
  writeField(path("f.npz"), field);
  succeed("convert f.npz all.vti");
  EXPECT_EQ(run("convert f.npz one.nrrd").err,
            "raymap: warning: one.nrrd: it has no place for these, which are left out: the array winding, "
            "the array "
            "triangle; a .npz, .vti, .vdb or .nvdb holds all\n");
  succeed("convert one.nrrd same.nrrd");
  EXPECT_EQ(run("convert one.nrrd a.npy").err,
            "raymap: warning: a.npy: it has no place for these, which are left out: the grid; a .npz, .vti, "
            ".vdb or .nvdb "
            "holds all\n");
  field.distance = {};
  writeField(path("w.npz"), field, {.array = FieldArray::Winding});
  succeed("convert w.npz w.nrrd");
  std::string bytes = readBytes(path("all.vti"));
  bytes.replace(bytes.find("winding"), 7, "density");
  std::ofstream(path("f.vti"), std::ios::binary) << bytes;
  for (const char* command : {"convert f.vti f.npz -f", "info f.vti", "render f.vti -o f.png --slice z"})
    EXPECT_EQ(run(command).err,
              "raymap: warning: f.vti: it also holds 'density', which a field has no place for\n");
}

// A level set of more than 2^24 samples stays a narrow band, in other commands too.
TEST_F(CliConvert, KeepsLargeLevelSetsAsNarrowBands) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid{{645, 590, 45}, {-1.2, -1.1, -1.05}, 0.05};
  const Field band = Surface(mesh).generateBand(grid, {.outside = 2.0, .inside = 4.0});
  const Field dense = toDense(band);
  writeField(path("band.vdb"), band);
  succeed("convert band.vdb slabs.nrrd");
  writeField(path("dense.nrrd"), dense);
  EXPECT_TRUE(readBytes(path("slabs.nrrd")) == readBytes(path("dense.nrrd")));
  succeed("convert band.vdb -o half.vdb --grid-name surface --half");
  EXPECT_TRUE(std::ranges::equal(readBand(path("half.vdb"), {.gridName = "surface"}).narrow->leaves,
                                 band.narrow->leaves));
  succeed("convert band.vdb -o mm.vdb --from cm --to mm");
  const Field scaled = readBand(path("mm.vdb"));
  EXPECT_EQ(scaled.activeCount(), band.activeCount());
  EXPECT_EQ(scaled.narrow->outside, 10.0 * band.narrow->outside);
  EXPECT_EQ(scaled.grid.spacing, 10.0 * band.grid.spacing);

  succeed("mesh band.vdb -o band.ply");
  const Simplified surface = simplify(isosurface(band), {.tolerance = 0.1 * 0.05, .step = 0.05});
  EXPECT_TRUE(readMesh(path("band.ply")).triangles == surface.mesh.triangles);

  const std::vector<glm::dvec3> points{{0, 0, 0.97}, {0.5, 0.5, 0.8}, {20, 9, 0.5}, {0.1, 0, 0}};
  std::ofstream(path("points.csv")) << "x,y,z\n0,0,0.97\n0.5,0.5,0.8\n20,9,0.5\n0.1,0,0\n";
  EXPECT_NE(run("query band.vdb points.csv -o band.csv --arrays distance,gradient")
                .err.find("2 of 4 points are beyond"),
            std::string::npos);
  writeSamples(path("dense.csv"), points, sample(dense, points, {.gradients = true}),
               {.arrays = {"distance", "gradient"}});
  EXPECT_EQ(readBytes(path("band.csv")), readBytes(path("dense.csv")));

  const Json info = Json::parse(succeed("info band.vdb --json").out);
  EXPECT_EQ(info["band"]["active"], band.activeCount());
  EXPECT_EQ(info["band"]["leaves"], band.narrow->leaves.size());
  EXPECT_EQ(info["grid"]["samples"], dense.distance.size());
  EXPECT_EQ(info["clamp_distance"], dense.clampDistance);
  EXPECT_EQ(info["min"], double(*std::ranges::min_element(dense.distance)));
  EXPECT_EQ(info["max"], double(*std::ranges::max_element(dense.distance)));
  EXPECT_EQ(info["inside"], std::ranges::count_if(dense.distance, [](float d) { return d < 0.0f; }));
  EXPECT_NE(succeed("info band.vdb").out.find("active samples"), std::string::npos);
}

/// Expects that a band of another lattice has the samples of `band`, up to rounding. Clamped ones have the
/// background of the file, which is rounded up.
void expectSameSamples(const Field& read, const Field& band, double rounding = 0.0) {
  EXPECT_TRUE(rounding > 0.0 || read.activeCount() == band.activeCount());
  EXPECT_DOUBLE_EQ(read.grid.spacing, band.grid.spacing);
  const glm::ivec3 offset(glm::round((read.grid.origin - band.grid.origin) / band.grid.spacing));
  EXPECT_NEAR(read.narrow->outside, band.narrow->outside, std::max(rounding, 1e-7 * band.narrow->outside));
  const auto clamped = [&](float distance) {
    if (distance == float(band.narrow->outside)) return float(read.narrow->outside);
    return distance == -float(band.narrow->inside) ? -float(read.narrow->inside) : distance;
  };
  size_t different = 0;
  for (size_t l = 0; l < read.narrow->leaves.size(); ++l)
    for (int i = 0; i < int(NarrowBand::kLeafSamples); ++i) {
      const glm::ivec3 within(i % 8, i / 8 % 8, i / 64);
      const float expected = clamped(band.distanceAt(read.narrow->leaves[l] + within + offset));
      const float found = read.distance[l * NarrowBand::kLeafSamples + size_t(i)];
      different += std::abs(double(found) - expected) <= rounding ? 0 : 1;
    }
  EXPECT_EQ(different, 0U);
}

TEST_F(CliConvert, AgreesWithNanoVdbsTools) {
  if (!hasFieldFormat(".nvdb")) GTEST_SKIP();
  if (shell("type nanovdb_validate nanovdb_convert").code != 0) GTEST_SKIP() << "without libnanovdb-tools";
  const Mesh mesh = shapes::torus(1.0, 0.4, 40, 20);
  const Field band = Surface(mesh).generateBand(fitGrid(mesh, {.resolution = 90}), {.triangle = true});
  const Field other = Surface(mesh).generateBand(fitGrid(mesh, {.resolution = 30}), {.winding = true});
  writeField(path("band.vdb"), band);
  succeed("convert band.vdb band.nvdb");
  EXPECT_TRUE(std::ranges::equal(readBand(path("band.nvdb")).distance, band.distance));
  writeFields(path("both.nvdb"), std::array{NamedField{"a", &band}, NamedField{"b", &other}});
  writeField(path("dense.nvdb"), toDense(band));
  succeed("convert band.vdb half.nvdb --half");
  for (const char* name :
       {"band.nvdb", "both.nvdb", "dense.nvdb", "half.nvdb"}) {  // It ends with 0, whatever it finds.
    const Result valid = shell(std::string("nanovdb_validate ") + name);
    EXPECT_EQ(valid.code, 0) << valid.err;
    EXPECT_EQ((valid.out + valid.err).find("ailed"), std::string::npos) << name << valid.out << valid.err;
  }
  for (const char* codec : {"", "-z"}) {
    EXPECT_EQ(shell(std::string("nanovdb_convert -f ") + codec + " -g distance band.vdb foreign.nvdb").code,
              0);
    expectSameSamples(readBand(path("foreign.nvdb")), band);
  }
  EXPECT_EQ(shell("nanovdb_convert -f -g distance band.nvdb again.vdb").code, 0);
  expectSameSamples(readBand(path("again.vdb")), band);
  EXPECT_EQ(shell("nanovdb_convert -f --fp16 -g distance band.vdb rounded.nvdb").code, 0);
  const double rounding = 1.02 * band.narrow->outside / 65535.0;
  expectSameSamples(readBand(path("rounded.nvdb")), band, rounding);
  EXPECT_EQ(shell("nanovdb_convert -f -g distance half.nvdb again.vdb").code, 0);
  expectSameSamples(readBand(path("again.vdb")), band, rounding);
}

TEST_F(CliConvert, ReadsTheGridThatItIsTold) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  const Field near = Surface(mesh).generateBand(grid),
              far = Surface(mesh).generateBand(grid, {.outside = 5.0});
  for (const std::string file : {"both.vdb", "both.nvdb"}) {
    writeFields(path(file), std::array{NamedField{"near", &near}, NamedField{"far", &far}});
    const auto convert = [&](const std::string& name) {
      return "convert " + file + " read.npz --grid " + name;
    };
    succeed(convert("near"));
    EXPECT_TRUE(std::ranges::equal(readField(path("read.npz")).distance, toDense(near).distance));
    expectFailure(convert("middle"), ErrorCode::Usage, "no grid 'middle'; its grids are 'far', 'near'");
    const Json info = Json::parse(succeed("info --json --grid near " + file).out);
    EXPECT_EQ(info["max"], double(float(near.narrow->outside)));
    succeed("mesh --grid near -o a.ply " + file);
    std::ofstream(path("points.csv")) << "x,y,z\n0.9,0.1,0\n";
    succeed("query --grid near -o a.csv " + file + " points.csv");
    succeed("render --grid near --size 16 16 -o a.png " + file);
    succeed("render --grid near --size 16 16 -o a.png " + file + " " + file);
    expectFailure("compare --grid near " + file + " read.npz", ErrorCode::Usage, "leave the name out");
    EXPECT_EQ(Json::parse(succeed("compare --json --grid near " + file + " " + file).out)["differences"], 0);
  }
  writeTorus();
  expectFailure("info torus.ply --grid near", ErrorCode::Usage, "leave the name out");
}

TEST_F(CliConvert, WritesSeveralBandsIntoOneFile) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Field body = Surface(mesh).generateBand(fitGrid(mesh, {.resolution = 20})),
              hull = Surface(mesh).generateBand({{30, 20, 10}, glm::dvec3(-1.0), 0.1}, {.winding = true});
  writeField(path("body.vdb"), body);
  writeField(path("hull.nvdb"), hull, {.gridName = "surface"});
  for (const std::string file : {"both.vdb", "both.nvdb"}) {
    succeed("convert body.vdb hull.nvdb -o " + file);
    expectSameSamples(readBand(path(file), {.gridName = "body"}), body);
    const Field read = readBand(path(file), {.gridName = "hull"});
    expectSameSamples(read, hull);
    EXPECT_TRUE(std::ranges::equal(read.winding, hull.winding));
    const Result info = run("info --json " + file);  // The first by name, and a warning of the others.
    EXPECT_EQ(Json::parse(info.out)["grid"]["samples"], body.grid.sampleCount());
    EXPECT_NE(info.err.find("'hull'"), std::string::npos) << info.err;
  }
  expectFailure("convert both.vdb both.nvdb -o x.vdb --grid body", ErrorCode::Usage,
                "two grids have the name 'both'");
  expectFailure("convert body.vdb hull.nvdb -o x.nrrd", ErrorCode::Usage, "x.nrrd is none");
  expectFailure("convert body.vdb hull.nvdb -o x.vdb --grid-name a", ErrorCode::Usage, "--grid-name");
  expectFailure("convert body.vdb hull.nvdb x.vdb", ErrorCode::Usage, "--output is required");
  expectFailure("convert body.vdb hull.nvdb -o hull.nvdb", ErrorCode::Usage, "--overwrite");
  writeTorus();
  expectFailure("convert body.vdb torus.ply -o x.vdb", ErrorCode::Usage, "torus.ply: it is a mesh");
  EXPECT_FALSE(std::filesystem::exists(path("x.vdb")));
}

TEST_F(CliConvert, NamesTheCommandForTheOtherKind) {
  writeTorus();
  succeed("generate torus.ply -o t.npz --resolution 8");
  const auto usage = ErrorCode::Usage;
  for (const char* command : {"repair t.npz -o a.stl", "generate t.npz -o a.npz", "sample t.npz -o s.npz"})
    expectFailure(
        command, usage,
        "t.npz: it is a field, and a mesh is needed; this makes one of it: raymap mesh t.npz -o t.ply");
  expectFailure(
      "compare t.npz torus.ply", usage,
      "torus.ply: it is a mesh, and a field is needed; this makes one of it: raymap generate torus.ply -o "
      "torus.npz");
  EXPECT_NE(shell("cat t.npz | $R repair - -o a.stl").err.find("raymap mesh - -o result.ply"),
            std::string::npos);
  EXPECT_NE(shell("mv t.npz 'a b.npz'; $R repair 'a b.npz' -o a.stl")
                .err.find("raymap mesh 'a b.npz' -o 'a b.ply'"),
            std::string::npos);
  EXPECT_EQ(fileCount(), 2u);
}

}  // namespace
}  // namespace raymap
