#include <gtest/gtest.h>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::errorOf;
using samples::isSquare;
using samples::read;
using samples::replaced;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ReadObj, CutsPolygonsAsFans) {
  EXPECT_TRUE(isSquare(read(readObj, samples::kObj).mesh));
  std::string ring, face = "f";
  for (int i = 0; i < 300; ++i) {
    const double angle = 0.02 * i;
    ring += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(read(readObj, ring + face).mesh.triangles.size(), 298u);
}

TEST(ReadObj, TakesAllFormsOfCorners) {
  for (const char* face :
       {"f 1/1 2/2 3/3 4/4", "f 1//1 2//1 3//1 4//1", "f 1/1/1 2/2/1 3/3/1 4/4/1", "f -4 -3 -2 -1",
        "f +1 2 \\\n 3 4", "f\t1 2  3 4 # square", "o x\ng y\ns off\nusemtl z\nf 1 2 3 4"})
    EXPECT_TRUE(isSquare(read(readObj, kVertices + face).mesh)) << face;
  EXPECT_TRUE(isSquare(read(readObj, "f 1 2 3 4\n" + kVertices).mesh)) << "a face before its vertices";
}

TEST(ReadObj, TakesAllLineEnds) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : samples::kObj) text += c == '\n' ? end : std::string(1, c);
    EXPECT_TRUE(isSquare(read(readObj, text).mesh)) << testing::PrintToString(end);
  }
}

TEST(ReadObj, IgnoresColoursAndWeights) {
  EXPECT_TRUE(isSquare(read(readObj, replaced(samples::kObj, "v 1 1 0", "v 1 1 0 nan nan nan")).mesh));
}

TEST(ReadObj, KeepsSmallMeshesFarAway) {
  const Mesh mesh =
      read(readObj, "v 1000000000.001 0 0\nv 1000000000.002 0 0\nv 1000000000.001 0.001 0\nf 1 2 3").mesh;
  EXPECT_NEAR(glm::length(mesh.vertices[1] - mesh.vertices[0]), 0.001, 1e-6);
}

TEST(ReadObj, WarnsOfWhatItDrops) {
  EXPECT_EQ(read(readObj, samples::kObj + "f 1 2\nsurf 0 1 0 1 1 2\n").warnings,
            "sample.mesh: free-form curves and surfaces are not read\n"
            "sample.mesh: 1 face with fewer than three corners dropped\n");
}

TEST(ReadObj, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(readObj, kVertices + "f 1 2 3\nf 1 2 9"),
            "sample.mesh: line 6: vertex index 9 is out of range (the file has 4 vertices)");
  EXPECT_TRUE(contains(errorOf(readObj, kVertices + "f 1 2 -5"), "line 5: vertex index -5 is out of range"));
  EXPECT_TRUE(contains(errorOf(readObj, kVertices + "f 0 1 2"), "line 5: vertex index 0 is out of range"));
  EXPECT_TRUE(contains(errorOf(readObj, "v 0 0 0\rv 1 x 0\r"), "line 2: expected a number, found 'x'"));
  EXPECT_TRUE(contains(errorOf(readObj, "v 0 0\nv 1 1 0\n"), "line 1: a vertex needs three coordinates"));
  EXPECT_TRUE(contains(errorOf(readObj, replaced(samples::kObj, "1 1 0", "1 nan 0")),
                       "vertex 2 (used by triangle 0) is not finite: (1, nan, 0)"));
  EXPECT_TRUE(contains(errorOf(readObj, replaced(samples::kObj, "1 1 0", "1 1e999 0")), "is not finite"));
  EXPECT_TRUE(contains(errorOf(readObj, replaced(samples::kObj, "1 1 0", "1 1e300 0")), "too far apart"));
  EXPECT_EQ(errorOf(readObj, kVertices), "sample.mesh: the file has no triangles");
}

TEST(ReadObj, TakesVerySmallNumbers) {
  EXPECT_TRUE(isSquare(read(readObj, replaced(samples::kObj, "1 1 0", "1 1 1e-999")).mesh));
}

}  // namespace
}  // namespace raymap
