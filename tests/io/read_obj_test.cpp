#include <gtest/gtest.h>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::cornersOfU;
using samples::errorOf;
using samples::faceOfU;
using samples::isSquare;
using samples::isU;
using samples::read;
using samples::replaced;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ReadObj, CutsConvexPolygonsAsFans) {
  EXPECT_TRUE(isSquare(read(readObj, samples::kObj).mesh));
  std::string ring, face = "f";
  for (int i = 0; i < 300; ++i) {
    const double angle = 0.02 * i;
    ring += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(read(readObj, ring + face).mesh.triangles.size(), 298u);
}

TEST(ReadObj, CutsConcavePolygons) {
  for (size_t first = 0; first < samples::kU.size(); ++first)
    for (const bool isReversed : {false, true})
      EXPECT_TRUE(isU(read(readObj, cornersOfU("v ") + "f" + faceOfU(first, isReversed, 1)).mesh)) << first;
  const samples::Reading late = read(readObj, "f" + faceOfU(1, false, 1) + "\n" + cornersOfU("v "));
  EXPECT_TRUE(isU(late.mesh)) << "a face before its vertices";
  EXPECT_EQ(late.warnings, "");
}

TEST(ReadObj, WarnsOncePerFileOfWhatItCannotCut) {
  const std::string crossed = "f 1 3 2 4\n";
  EXPECT_EQ(read(readObj, kVertices + crossed).warnings,
            "sample.mesh: 1 face crosses itself, or its corners lie on a line: its triangles may overlap\n");
  const samples::Reading reading = read(readObj, kVertices + crossed + "f 1 2 3\nf 1 2 1 2\n" + crossed);
  EXPECT_EQ(reading.warnings,
            "sample.mesh: 3 faces cross themselves, or their corners lie on a line: their triangles may "
            "overlap\n");
  EXPECT_EQ(reading.mesh.triangles.size(), 7u);
  EXPECT_EQ(reading.mesh.triangles[1], glm::uvec3(0, 1, 3));
}

TEST(ReadObj, ContinuesLines) {
  for (const char* face : {"f 1 2 3\\\n4", "f 1 2 3\\\n 4", "f 1 2 3 \\  \n4", "f 1 2 3\\ \t\r\n4",
                           "f 1 2 3\\\r4", "f 1\\\n2\\\n3\\\n4", "f 1//1 2//1 3//1\\\n4//1",
                           "f 1/1/1 2/2/1 3/3/1\\\n 4/4/1", "f 1/1 2/2 3/\\\n4/4", "f\\\n1 2 3 4",
                           "f 1 2 3 4\\\n", "f 1 2 3 4\\", "f -4 -3 -2\\\n-1", "f 1 2 3 4 \\\n\\\n"})
    EXPECT_TRUE(isSquare(read(readObj, kVertices + face).mesh)) << face;
  EXPECT_TRUE(isSquare(read(readObj, replaced(samples::kObj, "v 1 1 0", "v 1\\\n1 \\ \n0")).mesh));
  EXPECT_TRUE(isSquare(read(readObj, "g a \\\nb\n" + samples::kObj).mesh));
  EXPECT_TRUE(contains(errorOf(readObj, kVertices + "f 1 2 \\ 3 4"), "line 5: expected"));
}

TEST(ReadObj, SkipsAByteOrderMark) {
  EXPECT_TRUE(isSquare(read(readObj, "\xef\xbb\xbf" + samples::kObj).mesh));
  std::string wide;
  for (const char c : samples::kObj) wide += {c, '\0'};
  for (const std::string& text : {wide, '\0' + wide})
    EXPECT_EQ(errorOf(readObj, text), "sample.mesh: it is text in UTF-16; save it as UTF-8");
  EXPECT_TRUE(isSquare(read(readObj, std::string("\0\0\0\n", 4) + samples::kObj).mesh)) << "zeros are blanks";
  for (const char* mark : {"\xff\xfe", "\xfe\xff"})
    EXPECT_EQ(errorOf(readObj, mark + std::string("v\0 ", 3)),
              "sample.mesh: it is text in UTF-16; save it as UTF-8");
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

TEST(ReadObj, TakesSigns) {
  EXPECT_TRUE(isSquare(read(readObj, replaced(samples::kObj, "v 1 1 0", "v +1 +1.0 -0")).mesh));
}

TEST(ReadObj, TakesVerySmallNumbers) {
  EXPECT_TRUE(isSquare(read(readObj, replaced(samples::kObj, "1 1 0", "1 1 1e-999")).mesh));
}

}  // namespace
}  // namespace raymap
