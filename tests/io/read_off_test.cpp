#include <gtest/gtest.h>

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

TEST(ReadOff, WarnsOfWhatItDrops) {
  EXPECT_EQ(read(readOff, replaced(kOff, "4 1 0", "4 2 0") + "2 0 1\n").warnings,
            "sample.mesh: 1 face with fewer than three corners dropped\n");
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
  EXPECT_TRUE(contains(errorOf(readOff, replaced(kOff, "OFF", "4OFF")), "other than three dimensions"));
  EXPECT_TRUE(contains(errorOf(readOff, replaced(kOff, "OFF", "OFF BINARY")), "binary OFF"));
  EXPECT_TRUE(contains(errorOf(readOff, ""), "the file is empty"));
}

}  // namespace
}  // namespace raymap
