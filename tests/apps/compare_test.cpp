#include <cstdio>
#include <limits>
#include <map>
#include <utility>

#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliCompare : public Cli {};

TEST_F(CliCompare, ConvertsAndCompares) {
  writeTorus();
  succeed("generate torus.ply -o a.nrrd --resolution 24");
  succeed("convert a.nrrd b.npz");
  EXPECT_EQ(Json::parse(succeed("compare a.nrrd b.npz --json").out)["differences"], 0);
  succeed("generate torus.ply -o inverted.nrrd --resolution 24 --invert");
  const Json found = Json::parse(succeed("compare a.nrrd inverted.nrrd --json -o difference.png").out);
  EXPECT_EQ(found["sign_differences"], found["samples"]);
  EXPECT_TRUE(fs::exists(path("difference.png")));
  Field broken = readField(path("a.nrrd"));
  broken.distance[5] = std::numeric_limits<float>::quiet_NaN();
  writeField(path("broken.nrrd"), broken);
  EXPECT_EQ(Json::parse(succeed("compare a.nrrd broken.nrrd --json").out)["non_finite"], 1);
  EXPECT_NE(succeed("compare a.nrrd broken.nrrd").out.find("not finite        1,"), std::string::npos);
}

// Level sets of more than 2^24 samples.
TEST_F(CliCompare, ComparesNarrowBands) {
  if (!hasFieldFormat(".vdb")) GTEST_SKIP();
  const Grid grid{{645, 590, 45}, {-1.2, -1.1, -1.05}, 0.05};
  const Field a = Surface(shapes::sphere(1.0, 3)).generateBand(grid),
              b = Surface(shapes::sphere(0.9, 3)).generateBand(grid, {.outside = 2.0, .inside = 4.0});
  writeField(path("a.vdb"), a);
  writeField(path("b.vdb"), b);
  writeField(path("b.nrrd"), toDense(b));
  const Comparison wanted = compareFields(toDense(a), toDense(b));
  EXPECT_GT(wanted.signDifferences, 1000u);
  writePng(path("wanted.png"), renderComparison(toDense(a), toDense(b)));
  for (const char* other : {"b.vdb", "b.nrrd"}) {
    const Json found =
        Json::parse(succeed(std::string("compare a.vdb ") + other + " --json -o found.png -f").out);
    EXPECT_EQ(found["samples"], grid.sampleCount());
    EXPECT_EQ(found["sign_differences"], wanted.signDifferences);
    EXPECT_EQ(found["differences"], wanted.differences);
    EXPECT_EQ(found["max_error"], wanted.maxError);
    EXPECT_NEAR(double(found["mean_error"]), wanted.meanError, 1e-9);
    EXPECT_EQ(readBytes(path("found.png")), readBytes(path("wanted.png")));
  }
  expectFailure("compare a.vdb b.vdb --as winding", ErrorCode::Usage, "winding");
}

// Winding numbers, confidences and triangles, in files that name what they hold and in those that do not.
TEST_F(CliCompare, DrawsAndComparesTheOtherArrays) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).x > 2.2; });
  writeMesh(path("torn.ply"), mesh);
  const auto make = [&](const std::string& stem, const std::string& extension, const std::string& more) {
    succeed("generate torn.ply --resolution 24 --device cpu -o " + stem + ".nrrd --winding " + stem + "w" +
            extension + " --confidence " + stem + "c" + extension + " --triangle-ids " + stem + "t" +
            extension + more);
  };
  std::map<std::string, std::string> pictures;
  for (const std::string extension : {".nrrd", ".npy"}) {
    make("a", extension, "");
    for (const auto& [letter, array] : {std::pair("w", "winding"), {"c", "confidence"}, {"t", "triangle"}}) {
      const std::string file = "a" + std::string(letter) + extension;
      const bool isNamed = extension != ".npy" || array == std::string("triangle");
      const std::string as = isNamed ? "" : std::string(" --as ") + array;
      succeed("render " + file + " -o slice.png --slice z --size 96 72" + as);
      const std::string picture = readBytes(path("slice.png"));
      if (pictures.contains(letter)) {
        EXPECT_EQ(picture, pictures[letter]) << file;
      }
      pictures[letter] = picture;
      if (isNamed)
        expectFailure("render " + file + " -o solid.png", ErrorCode::Usage,
                      file + ": the array '" + array + "' has no surface to draw; draw a slice of it");
      const Json same = Json::parse(succeed("compare " + file + " " + file + " --json" + as).out);
      EXPECT_EQ(same["array"], array);
      EXPECT_EQ(same["differences"], 0);
    }
  }
  EXPECT_NE(pictures["w"], pictures["c"]);
  EXPECT_NE(pictures["w"], pictures["t"]);
  // From the mesh itself.
  succeed("render torn.ply --resolution 24 --device cpu -o slice.png --slice z --size 96 72 --as winding");
  EXPECT_EQ(readBytes(path("slice.png")), pictures["w"]);

  make("b", ".nrrd", " --sign rays --distance cell");
  make("a", ".nrrd", "");
  const Field a = readField(path("aw.nrrd")), b = readField(path("bw.nrrd"));
  const Json found = Json::parse(succeed("compare aw.nrrd bw.nrrd --json -o difference.png").out);
  EXPECT_EQ(found["max_error"], compareFields(a, b, FieldArray::Winding).maxError);
  EXPECT_GT(found["max_error"], 0.1);
  EXPECT_TRUE(fs::exists(path("difference.png")));
  const std::string text = succeed("compare at.nrrd bt.nrrd").out;
  const Comparison ids =
      compareFields(readField(path("at.nrrd")), readField(path("bt.nrrd")), FieldArray::Triangle);
  char share[32];
  std::snprintf(share, sizeof share, ", %.4g %%\n", 100.0 * double(ids.differences) / double(ids.samples));
  EXPECT_NE(text.find("\ndifferences       "), std::string::npos) << text;
  EXPECT_NE(text.find(share), std::string::npos) << text << share;
  EXPECT_EQ(Json::parse(succeed("compare at.nrrd bt.nrrd --json").out)["differences"], ids.differences);
  EXPECT_EQ(text.find("largest"), std::string::npos) << text;
  EXPECT_NE(succeed("compare aw.nrrd bw.nrrd").out.find("mean              0."), std::string::npos);

  expectFailure("compare aw.nrrd at.nrrd", ErrorCode::Usage,
                "aw.nrrd holds the array 'winding', at.nrrd the array 'triangle'");
  expectFailure("compare aw.nrrd bw.nrrd --as triangle", ErrorCode::Usage,
                "aw.nrrd: it holds the array 'winding', not 'triangle'; leave out --as");
  expectFailure("render aw.nrrd -o f.png --slice z --as distance", ErrorCode::Usage, "leave out --as");
  expectFailure("render a.nrrd -o f.png --slice z --as colour", ErrorCode::Usage, "--as");
  expectFailure("mesh aw.nrrd -o f.ply", ErrorCode::Usage, "and no distances");
  EXPECT_FALSE(fs::exists(path("f.png")));
}

}  // namespace
}  // namespace raymap
