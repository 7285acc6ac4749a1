#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::errorOf;
using samples::isSquare;
using samples::kOff;
using samples::read;
using samples::replaced;

TEST(ReadOff, ReadsItsVariants) {
  EXPECT_TRUE(isSquare(read(readOff, kOff).mesh));
  EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "OFF\n4 1 0", "OFF 4 1")).mesh)) << "all on one line";
  EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "OFF\n", "")).mesh)) << "without its keyword";
  EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "OFF\n", "OFF # a\n\n# comment\n")).mesh)) << "comments";
  EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "4 0 1 2 3", "4 0 1 2 3 255 0 0")).mesh))
      << "face colour";
  EXPECT_TRUE(isSquare(read(readOff,
                            "CNOFF\n4 1 0\n0 0 0 0 0 1 9 9 9 9\n1 0 0 0 0 1 9 9 9 9\n1 1 0 0 0 1 9 9 9 9\n"
                            "0 1 0 0 0 1 9 9 9 9\n4 0 1 2 3\n")
                           .mesh));
}

TEST(ReadOff, CutsConcavePolygons) {
  for (size_t first = 0; first < samples::kU.size(); ++first)
    for (const bool isReversed : {false, true})
      EXPECT_TRUE(samples::isU(
          read(readOff, "OFF\n8 1 0\n" + samples::cornersOfU() + "8" + samples::faceOfU(first, isReversed))
              .mesh));
  EXPECT_EQ(read(readOff, replaced(kOff, "0 1 2 3", "0 2 1 3")).warnings,
            "sample.mesh: 1 face crosses itself, or its corners lie on a line: its triangles may overlap\n");
}

TEST(ReadOff, TakesWordsInAnyCase) {
  for (const char* word : {"off", "Off", "oFF"})
    EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "OFF", word)).mesh)) << word;
  EXPECT_TRUE(isSquare(read(readOff, "\xef\xbb\xbf" + kOff).mesh)) << "a byte order mark";
}

TEST(ReadOff, ReadsHomogeneousCoordinates) {
  EXPECT_TRUE(
      isSquare(read(readOff, "4OFF\n4 1 0\n0 0 0 1\n2 0 0 2\n0.5 0.5 0 0.5\n0 -1 0 -1\n4 0 1 2 3\n").mesh));
  EXPECT_TRUE(contains(errorOf(readOff, "4OFF\n4 1 0\n0 0 0 1\n2 0 0 2\n1 1 0 0\n0 1 0 1\n4 0 1 2 3\n"),
                       "is not finite"));
}

TEST(ReadOff, BreaksLinesAnywhere) {
  const std::string one = "OFF 4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3";
  EXPECT_TRUE(isSquare(read(readOff, one).mesh));
  std::string each = one;
  std::ranges::replace(each, ' ', '\n');
  EXPECT_TRUE(isSquare(read(readOff, each).mesh));
  for (const char* text :
       {"OFF\n4 1 0\n0 0 0  1 0 0\n1 1 0  0 1 0\n4 0 1 2 3\n",
        "OFF\n4\n1\n0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3",
        "OFF\n4 1 0\n0 0 0  1 0 0\n1 1 0  0 1 0\n4 0\n1\n2\n3\n", "4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3",
        "COFF\n4 1 0\n0 0 0 9 9 9 9  1 0 0 9 9 9 9\n1 1 0 9 9 9 9  0 1 0 9 9 9 9\n4 0 1 2 3",
        "COFF\n4 1 0\n0 0 0 9 9 9  1 0 0 9 9 9\n1 1 0 9 9 9  0 1 0 9 9 9\n4 0 1 2 3",
        "STNOFF\n4 1 0\n0 0 0 9 9 9 9 9  1 0 0 9 9 9 9 9\n1 1 0 9 9 9 9 9  0 1 0 9 9 9 9 9\n4 0 1 2 3"})
    EXPECT_TRUE(isSquare(read(readOff, text).mesh)) << text;
  for (const char* counts :
       {"OFF\n4\n1\n0\n", "OFF\n4 1\n0\n", "OFF 4\n1 0\n", "4\n1 # faces\n0\n", "OFF\n4 1\n"})
    EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "OFF\n4 1 0\n", counts)).mesh)) << counts;
  // Faces with colours, behind vertices that share lines.
  EXPECT_TRUE(isSquare(read(readOff, "OFF\n4 1 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n4 0 1 2 3 255 0 0\n").mesh));
  // Two faces, each on a line, behind vertices that share one.
  EXPECT_EQ(read(readOff, "OFF 4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n3 0 1 2\n3 0 2 3").mesh.triangles.size(), 2u);
  // Lines with more than they need stay lines, whatever follows.
  EXPECT_TRUE(isSquare(read(readOff, replaced(kOff, "1 1 0\n", "1 1 0 7\n") + "rest").mesh));
  EXPECT_EQ(errorOf(readOff, "OFF 4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 4"),
            "sample.mesh: line 1: the file ends where a number should be");
}

std::string swapped(std::initializer_list<float> values) {
  return samples::raw<float>(values, true);
}
std::string swappedInts(std::initializer_list<int32_t> values) {
  return samples::raw<int32_t>(values, true);
}

TEST(ReadOff, ReadsBinaryFiles) {
  const std::string face = swappedInts({4, 0, 1, 2, 3, 0});
  const std::string plain = samples::binaryOff();
  EXPECT_TRUE(isSquare(read(readOff, plain).mesh));
  EXPECT_EQ(read(readOff, plain).warnings, "");
  const std::string coloured = swappedInts({4, 0, 1, 2, 3, 3}) + swapped({9, 9, 9});
  EXPECT_TRUE(isSquare(read(readOff, replaced(plain, face, coloured)).mesh));
  EXPECT_TRUE(isSquare(read(readOff, "4OFF BINARY\r\n" + swappedInts({4, 1, 7}) +
                                         swapped({0, 0, 0, 1, 2, 0, 0, 2, 1, 1, 0, 1, 0, -1, 0, -1}) + face)
                           .mesh));
  std::string others;
  for (const glm::ivec2& p : {glm::ivec2(0, 0), {1, 0}, {1, 1}, {0, 1}})
    others += swapped({float(p.x), float(p.y), 0, 8, 8, 8, 9, 9, 9, 9, 7, 7});
  EXPECT_TRUE(isSquare(read(readOff, "STCNOFF BINARY\n" + swappedInts({4, 1, 0}) + others + face).mesh));
  EXPECT_EQ(read(readOff, plain + "abc").warnings, "sample.mesh: 3 bytes after the last face ignored\n");
  EXPECT_TRUE(samples::isU(
      read(readOff, "OFF BINARY\n" + swappedInts({8, 1, 0}) +
                        swapped({0, 0, 0, 3, 0, 0, 3, 3, 0, 2, 3, 0, 2, 1, 0, 1, 1, 0, 1, 3, 0, 0, 3, 0}) +
                        swappedInts({8, 1, 2, 3, 4, 5, 6, 7, 0, 0}))
          .mesh));

  const std::string misfit = "its counts do not fit its size";
  for (size_t size = sizeof("OFF BINARY"); size < plain.size(); ++size)
    EXPECT_TRUE(contains(errorOf(readOff, plain.substr(0, size)), misfit)) << size;
  EXPECT_TRUE(contains(errorOf(readOff, replaced(plain, swappedInts({4, 1}), swappedInts({5, 1}))), misfit));
  EXPECT_TRUE(contains(errorOf(readOff, replaced(plain, swappedInts({4, 1}), swappedInts({-1, 1}))), misfit));
  EXPECT_TRUE(contains(errorOf(readOff, replaced(plain, face, swappedInts({4, 0, 1, 2, 4, 0}))),
                       "face 0: vertex index 4 is out of range"));
}

TEST(ReadOff, WarnsOfWhatItDrops) {
  EXPECT_EQ(read(readOff, replaced(kOff, "4 1 0", "4 2 0") + "2 0 1\n").warnings,
            "sample.mesh: 1 face with fewer than three corners dropped\n");
  EXPECT_EQ(read(readOff, replaced(kOff, "4 1 0", "4 2 0") + "0\n").warnings,
            "sample.mesh: 1 face with fewer than three corners dropped\n");
  EXPECT_TRUE(contains(errorOf(readOff, replaced(kOff, "4 1 0", "4 2 0") + "-1\n"), "face 1 has -1 corners"));
}

TEST(ReadOff, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(readOff, replaced(kOff, "4 0 1 2 3", "4 0 1 2 99")),
            "sample.mesh: line 7: face 0: vertex index 99 is out of range (the file has 4 vertices)");
  EXPECT_TRUE(
      contains(errorOf(readOff, replaced(kOff, "4 1 0", "4000000000 1 0")), "line 2: the file announces"));
  EXPECT_TRUE(
      contains(errorOf(readOff, replaced(kOff, "4 1 0", "4 4000000000 0")), "announces 4000000000 faces"));
  EXPECT_TRUE(contains(errorOf(readOff, replaced(kOff, "4 1 0", "4 3 0")), "the file ends where"));
  EXPECT_TRUE(contains(errorOf(readOff, replaced(kOff, "4 1 0", "-4 1 0")), "negative"));
  EXPECT_TRUE(
      contains(errorOf(readOff, replaced(kOff, "1 1 0", "1 inf 0")), "vertex 2 (used by triangle 0)"));
  for (const char* word : {"nOFF", "4nOFF", "XOFF", "CSTOFF"})
    EXPECT_EQ(errorOf(readOff, replaced(kOff, "OFF", word)),
              std::string("sample.mesh: ") + word + " with other than three dimensions");
  EXPECT_TRUE(contains(errorOf(readOff, ""), "the file is empty"));
}

}  // namespace
}  // namespace raymap
