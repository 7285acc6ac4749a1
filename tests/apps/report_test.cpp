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

}  // namespace
}  // namespace raymap
