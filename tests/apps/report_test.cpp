#include "report.h"

#include <gtest/gtest.h>

namespace raymap {
namespace {

TEST(Report, ListsStepsTheRestAndTheTimeThatHasElapsed) {
  EXPECT_EQ(describeTimes({{"load", 1.5}, {"exact_distance_of_all", 1000.25}}, 1234.5),
            "  load                        1.5 ms\n"
            "  exact_distance_of_all     1000.2 ms\n"
            "  other                     232.8 ms\n"
            "  elapsed                  1234.5 ms\n");
}

TEST(Report, ShowsTheTimeThatHasElapsedWhereStepsOverlap) {
  EXPECT_EQ(describeTimes({{"load", 3.0}, {"write", 4.0}}, 5.0),
            "  load                        3.0 ms\n"
            "  write                       4.0 ms\n"
            "  other                       0.0 ms\n"
            "  elapsed                     5.0 ms\n");
}

TEST(RepairNotice, IsForFineGridsThatTheThinnestPartChose) {
  RepairGrid grid{{{256, 256, 512}, glm::dvec3(0.0), 1.0}};
  grid.surfaceCubes = 150000.0;
  EXPECT_EQ(whyItTakesLong(grid), "");
  grid.thinnest = 2.0;
  EXPECT_EQ(
      whyItTakesLong(grid),
      "this takes a while: about 1.5e+05 cubes of samples at the surface, because the thinnest part is 2 "
      "thick; --resolution 256 takes 25 % of them, but is too coarse for that part");
  grid.surfaceCubes = 131072.0;
  EXPECT_EQ(whyItTakesLong(grid), "");
  grid.surfaceCubes = 150000.0;
  grid.thinnest = 1.9;  // Too thin for these samples.
  EXPECT_EQ(whyItTakesLong(grid), "");
  grid.thinnest = 2.0;
  grid.dims.z = 256;
  EXPECT_EQ(whyItTakesLong(grid), "");
}

TEST(SlowestStep, TakesStepsOfANameTogether) {
  EXPECT_EQ(slowestStep({{"a", 3.0}, {"b", 2.0}, {"c", 1.0}, {"b", 2.0}}).name, "b");
  EXPECT_EQ(slowestStep({{"a", 3.0}, {"b", 2.0}, {"c", 1.0}, {"b", 2.0}}).milliseconds, 4.0);
}

}  // namespace
}  // namespace raymap
