// Remedies of warnings, in the words of the command line.

#include "warnings.h"

#include <raymap/names.h>

#include "cli.h"

namespace raymap {
namespace {

class CliWarnings : public Cli {};

TEST_F(CliWarnings, NameTheirRemedy) {
  EXPECT_EQ(remedyOf({WarningCode::DeviceRefused, "", {.device = "vulkan:3"}}),
            "raymap devices --test vulkan:3");
  EXPECT_EQ(remedyOf({WarningCode::SolidLost, "", {.voxelSize = 0.015}}), "--voxel-size 0.015");
  EXPECT_EQ(remedyOf({WarningCode::SolidLost, "", {}}), "");
  EXPECT_EQ(remedyOf({WarningCode::NothingInside, "", {.voxelSize = 0.02}}), "--voxel-size 0.02");
  EXPECT_EQ(remedyOf({WarningCode::NothingInside, "", {.length = 0.2}}), "--thickness 0.2");
}

TEST_F(CliWarnings, NameFlagsThatThereAre) {
  const std::string help = succeed("repair --help").out + succeed("mesh --help").out;
  int flags = 0;
  for (const std::string_view each : names<WarningCode>()) {
    const std::string remedy = remedyOf({fromName<WarningCode>(each), "", {.voxelSize = 1.0}});
    if (!remedy.starts_with("--")) continue;
    ++flags;
    EXPECT_NE(help.find(remedy.substr(0, remedy.find(' '))), std::string::npos) << remedy;
  }
  EXPECT_GE(flags, 8);
}

}  // namespace
}  // namespace raymap
