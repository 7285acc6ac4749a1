#include <gtest/gtest.h>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::binaryStl;
using samples::contains;
using samples::errorOf;
using samples::isSquare;
using samples::kTextStl;
using samples::read;
using samples::replaced;

TEST(ReadStl, TellsTextAndBinaryApartByContent) {
  EXPECT_TRUE(isSquare(read(readStl, kTextStl).mesh));
  EXPECT_TRUE(isSquare(read(readStl, binaryStl()).mesh));
  EXPECT_TRUE(isSquare(read(readStl, binaryStl().replace(0, 6, "solid ")).mesh)) << "binary that says solid";
}

TEST(ReadStl, KeepsThreeVerticesAFacet) {
  EXPECT_EQ(read(readStl, binaryStl()).mesh.vertices.size(), 6u);
  EXPECT_EQ(read(readStl, kTextStl).mesh.vertices.size(), 6u);
}

TEST(ReadStl, TakesAllLayoutsOfText) {
  for (const char* end : {"\r\n", "\r", " \t\n\n"}) {
    std::string text;
    for (const char c : kTextStl) text += c == '\n' ? end : std::string(1, c);
    EXPECT_TRUE(isSquare(read(readStl, text).mesh)) << testing::PrintToString(end);
  }
  std::string upper = kTextStl;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  EXPECT_TRUE(isSquare(read(readStl, upper).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "solid square", "solid facet vertex 1 2 3")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "endloop", "endloop remark 7")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "normal 0 0 1", "normal nan nan nan")).mesh));
  EXPECT_EQ(read(readStl, kTextStl + kTextStl).mesh.triangles.size(), 4u) << "two solids";
}

TEST(ReadStl, WarnsOfLooseEnds) {
  EXPECT_EQ(read(readStl, binaryStl() + "xyz").warnings,
            "sample.mesh: 3 bytes after the last triangle ignored\n");
  EXPECT_TRUE(
      contains(read(readStl, replaced(kTextStl, "endsolid square\n", "")).warnings, "without endsolid"));
}

TEST(ReadStl, NamesWhatIsWrong) {
  EXPECT_EQ(
      errorOf(readStl, binaryStl(20)),
      "sample.mesh: the file announces 20 triangles, but holds only 2 (it is cut short, or not an STL file)");
  EXPECT_TRUE(contains(errorOf(readStl, binaryStl(4000000000u)), "announces 4000000000 triangles"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1 O 0")),
                       "line 5: expected a number, found 'O'"));
  EXPECT_TRUE(
      contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1 inf 0")), "vertex 1 (used by triangle 0)"));
  EXPECT_TRUE(
      contains(errorOf(readStl, kTextStl.substr(0, kTextStl.rfind("vertex"))), "ends within a facet"));
  EXPECT_TRUE(
      contains(errorOf(readStl, replaced(kTextStl, " endloop\nendfacet", "")), "begins within a facet"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "endfacet\nfacet", "endfacet\nfascet")),
                       "expected facet"));
  EXPECT_EQ(errorOf(readStl, "solid Empty\nendsolid Empty"), "sample.mesh: the file has no triangles");
  EXPECT_EQ(errorOf(readStl, binaryStl(0).substr(0, 84)), "sample.mesh: the file has no triangles");
  EXPECT_NE(errorOf(readStl, ""), "");
}

}  // namespace
}  // namespace raymap
