#include <algorithm>

#include "cli.h"

namespace raymap {
namespace {

class CliRender : public Cli {};

TEST_F(CliRender, DrawsPictures) {
  writeTorus();
  succeed("generate torus.ply -o torus.nrrd --resolution 24");
  succeed("render torus.nrrd -o picture.png --size 64 48");
  const std::string png = readBytes(path("picture.png"));
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x40\0\0\0\x30", 8));  // IHDR: width, height.
  succeed("render torus.nrrd -o cut.png --size 64 48 --cut --shell 0.2");
  EXPECT_NE(readBytes(path("cut.png")), png);
  succeed("render torus.ply -o direct.png --resolution 24 --size 64 48");
  EXPECT_EQ(readBytes(path("direct.png")), png);
  expectFailure("render torus.nrrd -o gpu.png --device gpu", ErrorCode::Usage, "'gpu'");
  expectFailure("render torus.nrrd -o gpu.png --device vulkan:99", ErrorCode::Unsupported, "vulkan:99");
  EXPECT_FALSE(fs::exists(path("gpu.png")));
  const Result slice = succeed("render torus.nrrd -o slice.png --slice z --index 3");
  EXPECT_EQ(slice.out.rfind("wrote slice.png, ", 0), 0u) << slice.out;
  expectFailure("render torus.nrrd -o slice.png --slice z --index 99", ErrorCode::Usage, "across z");
  EXPECT_TRUE(fs::exists(path("slice.png")));
}

TEST_F(CliRender, DrawsNumbersAndDifferencesInColour) {
  writeTorus();
  const Mesh torus = readMesh(path("torus.ply"));
  const Mesh ball = shapes::sphere(1.5, 3, {0.5, 0.0, 0.0});
  writeMesh(path("ball.ply"), ball);
  const RenderOptions usual{.width = 64, .height = 48, .cutPlane = Plane{{1.0, 0.0, 0.0}, 0.1}};
  const auto drawn = [&](const std::string& arguments) {
    succeed("render " + arguments +
            " -o p.png --size 64 48 --resolution 24 --cut-plane 1,0,0,0.1 --device cpu");
    return readBytes(path("p.png"));
  };
  const auto expected = [&](const Field& field, const RenderOptions& options) {
    writePng(path("expected.png"), renderField(field, options, {.device = "cpu"}));
    return readBytes(path("expected.png"));
  };
  RenderOptions options = usual;
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence}) {
    options.array = array;
    const Field field =
        generate(torus, fitGrid(torus, {.resolution = 24}),
                 {.winding = array == FieldArray::Winding, .confidence = array == FieldArray::Confidence},
                 {.device = "cpu"})
            .field;
    EXPECT_EQ(drawn("torus.ply --as " + std::string(name(array))), expected(field, options));
  }
  // Two meshes share a grid over both; a mesh takes that of a field.
  const Box a = bounds(torus), b = bounds(ball);
  const Grid both = fitGrid(Box{glm::min(a.min, b.min), glm::max(a.max, b.max)}, {.resolution = 24});
  const auto fieldOn = [&](const Grid& grid, const Mesh& mesh) {
    return generate(mesh, grid, {}, {.device = "cpu"}).field;
  };
  const Field first = fieldOn(both, torus), second = fieldOn(both, ball);
  options = usual;
  EXPECT_EQ(drawn("torus.ply ball.ply --as distance"), expected(first, options));
  options.other = &second;
  options.range = 0.3;
  EXPECT_EQ(drawn("torus.ply ball.ply --range 0.3"), expected(first, options));
  options.other = &first;
  EXPECT_EQ(drawn("ball.ply torus.ply --range 0.3"), expected(second, options));
  succeed("generate ball.ply -o ball.nrrd --resolution 20 --device cpu");
  const Field given = readField(path("ball.nrrd"));
  const Field beside = fieldOn(given.grid, torus);
  options.other = &given;
  EXPECT_EQ(drawn("torus.ply ball.nrrd --range 0.3"), expected(beside, options));
  options.other = &beside;
  EXPECT_EQ(drawn("ball.nrrd torus.ply --range 0.3"), expected(given, options));
  expectFailure("render torus.ply ball.ply -o p.png --slice z", ErrorCode::Usage, "--slice-plane");
  expectFailure("render torus.ply ball.ply -o p.png --frames 0:3", ErrorCode::Usage, "leave the other out");
  expectFailure("render torus.ply -o p.png --as triangle", ErrorCode::Usage, "has no surface to draw");
}

// A level set of more than 2^24 samples stays a narrow band.
TEST_F(CliRender, DrawsNarrowBands) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Mesh ball = shapes::sphere(1.0, 2);
  const Field band = Surface(ball).generateBand(fitGrid(ball, {.resolution = 260}), {.winding = true});
  writeField(path("band.vdb"), band);
  const RenderOptions options{.width = 64, .height = 48};
  const auto expectDrawn = [&](const std::string& arguments, const Picture& expected) {
    succeed("render band.vdb " + arguments + " -o p.png --size 64 48");
    writePng(path("expected.png"), expected);
    EXPECT_EQ(readBytes(path("p.png")), readBytes(path("expected.png")));
  };
  expectDrawn("", renderField(band, options));
  expectDrawn("--slice x --index 7", renderSlice(band, 0, 7, 64));
  expectDrawn("--slice z --as winding", renderSlice(band, 2, -1, 64, FieldArray::Winding));
  RenderOptions ofWinding = options;
  ofWinding.cut = true;
  ofWinding.array = FieldArray::Winding;
  expectDrawn("--cut --as winding", renderField(band, ofWinding));
  // Two of them, of which neither becomes dense, and one beside a dense field or a mesh.
  const Mesh small = shapes::sphere(0.99, 2);
  const Field other = Surface(small).generateBand(fitGrid(small, {.resolution = 258}));
  writeField(path("other.vdb"), other);
  RenderOptions ofBoth = options;
  ofBoth.other = &other;
  ofBoth.range = 0.02;
  expectDrawn("other.vdb --range 0.02", renderField(band, ofBoth));
  expectDrawn("other.vdb --cut --as winding", renderField(band, ofWinding));
  writeMesh(path("small.ply"), small);
  expectDrawn("small.ply --cut --as winding", renderField(band, ofWinding));
  succeed("generate small.ply -o dense.nrrd --resolution 40");
  const Field dense = readField(path("dense.nrrd"));
  ofBoth.other = &dense;
  expectDrawn("dense.nrrd --range 0.02", renderField(band, ofBoth));
  expectFailure("render band.vdb other.vdb -o n.png --device vulkan", ErrorCode::Usage, "drawn on the CPU");
  expectFailure("render band.vdb other.vdb -o n.png --as confidence", ErrorCode::Usage, "leave out --as");
  expectFailure("render band.vdb -o n.png --as confidence", ErrorCode::Usage, "leave out --as");
  expectFailure("render band.vdb -o n.png --slice z --as confidence", ErrorCode::Usage, "leave out --as");
}

TEST_F(CliRender, WritesPages) {
  writeTorus();
  succeed("generate torus.ply -o torus.nrrd --resolution 24");
  const Result page = succeed("render torus.nrrd -o page.html --size 64 48");
  EXPECT_EQ(page.out.rfind("wrote page.html, ", 0), 0u) << page.out;
  EXPECT_EQ(page.out.find("it shows"), std::string::npos);
  EXPECT_NE(readBytes(path("page.html")).find("<title>torus.nrrd</title>"), std::string::npos);
  EXPECT_NE(succeed("render torus.nrrd -o page.html --size 64 48 --max-size 12").out.find("it shows 12 x "),
            std::string::npos);
  EXPECT_EQ(shell("$R render torus.nrrd -o - --size 64 48 --format html 2>.text | head -c 15").out,
            "<!DOCTYPE html>");
  expectFailure("render torus.nrrd -o page.html --slice z", ErrorCode::Usage, "leave out --slice");
  expectFailure("render torus.nrrd -o page.html --max-size 1", ErrorCode::Usage, "at least 2 samples");
  succeed("generate torus.ply -o d.nrrd --winding w.nrrd --resolution 8");
  expectFailure("render w.nrrd -o page.html", ErrorCode::Usage, "it has no distances");
}

// Level sets of more than 2^24 samples are shown by their surfaces, beside anything.
TEST_F(CliRender, WritesPagesOfNarrowBands) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const auto write = [&](const std::string& file, const Mesh& mesh, int resolution) {
    Field band = Surface(mesh).generateBand(fitGrid(mesh, {.resolution = resolution, .padding = 1.5}),
                                            {.confidence = true});
    writeField(path(file), band);
    return band;
  };
  const Mesh ball = shapes::sphere(1.0, 2), small = shapes::sphere(0.9, 2);
  const Field band = write("band.vdb", ball, 260), other = write("other.vdb", small, 258);
  writeMesh(path("small.ply"), small);
  const MachineOptions onCpu{.device = "cpu"};
  const Field dense = generate(small, fitGrid(small, {.resolution = 20}), {}, onCpu).field;
  writeField(path("dense.npz"), dense);
  const Grid grid = pageGrid(band.grid, 24);
  const Field onPage = generate(small, grid, {}, onCpu).field;
  const RenderOptions view{.width = 64, .height = 48};
  const std::string options = " -o page.html --size 64 48 --max-size 24 --device cpu";
  const auto expectPage = [&](const std::string& shapes, const Page& expected) {
    const std::string out = succeed("render " + shapes + options).out;
    EXPECT_EQ(readBytes(path("page.html")), expected.html) << shapes;
    return out;
  };
  const auto pageOf = [&](const auto& first, PageOptions page) {
    page.maxSize = 24;
    return makePage(first, view, page, onCpu);
  };
  std::string out = expectPage("band.vdb", pageOf(band, {.title = "band.vdb"}));
  EXPECT_NE(out.find("it shows 24 x 24 x 24 samples of 260 x 260 x 260"), std::string::npos) << out;
  EXPECT_NE(out.find("it shows the distances of the narrow band"), std::string::npos) << out;
  const PageOptions beside{.title = "band.vdb", .otherTitle = "small.ply"};
  PageOptions both = beside;
  both.other = &onPage;
  out = expectPage("band.vdb small.ply", pageOf(band, both));
  EXPECT_EQ(out.find("on the grid of"), std::string::npos) << out;
  both = {.title = "band.vdb", .other = &dense, .otherTitle = "dense.npz"};
  out = expectPage("band.vdb dense.npz", pageOf(band, both));
  EXPECT_NE(out.find("it shows dense.npz on the grid of band.vdb"), std::string::npos) << out;
  both = {.title = "band.vdb", .other = &other, .otherTitle = "other.vdb"};
  expectPage("band.vdb other.vdb", pageOf(band, both));
  both = {.title = "dense.npz", .other = &band, .otherTitle = "band.vdb"};
  expectPage("dense.npz band.vdb", pageOf(dense, both));
  both = {.title = "small.ply", .mesh = small, .other = &band, .otherTitle = "band.vdb"};
  expectPage("small.ply band.vdb", pageOf(onPage, both));
  expectFailure("render band.vdb --as confidence" + options, ErrorCode::Usage, "draw it as a picture");
  expectFailure("render band.vdb --max-size 1 -o page.html", ErrorCode::Usage, "at least 2 samples");
}

TEST_F(CliRender, DrawsFilesOfPrintersAndCadWithZUp) {
  writeTorus();
  succeed("convert torus.ply torus.stl");
  const std::string small = " --size 32 24 --resolution 24 -o ";
  const auto drawn = [&](const std::string& arguments) {
    succeed(arguments + " p.png");
    return readBytes(path("p.png"));
  };
  const std::string zUp = drawn("render torus.ply --up 0 0 1 --direction -0.6 1 -0.45" + small);
  const std::string yUp = drawn("render torus.ply --up 0 1 0 --direction -0.6 -0.45 -1" + small);
  EXPECT_NE(zUp, yUp);
  EXPECT_EQ(drawn("render torus.ply" + small), yUp);
  EXPECT_EQ(drawn("render torus.ply --up 0 0 1" + small), zUp);
  EXPECT_EQ(drawn("render torus.stl" + small), zUp);
  EXPECT_EQ(drawn("render torus.stl --up 0 1 0" + small), yUp);
  EXPECT_EQ(shell("$R render - --format stl < torus.stl 2>.text" + small + "-").out, zUp);
  EXPECT_EQ(shell("$R render - --format ply < torus.ply 2>.text" + small + "-").out, yUp);

  EXPECT_EQ(drawn("info torus.stl --size 32 24 --picture"),
            drawn("info torus.ply --size 32 24 --up 0 0 1 --picture"));
  EXPECT_NE(drawn("info torus.stl --size 32 24 --picture"), drawn("info torus.ply --size 32 24 --picture"));
  succeed("generate torus.stl -o f.nrrd --resolution 8 --report-picture r.png");
  EXPECT_EQ(readBytes(path("r.png")), drawn("info torus.ply --up 0 0 1 --picture"));
}

}  // namespace
}  // namespace raymap
