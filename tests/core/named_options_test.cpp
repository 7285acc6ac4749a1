#include <raymap/named_options.h>
#include <raymap/names.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "error_code.h"

namespace raymap {
namespace {

std::string messageOf(const char* name, const OptionValue& value) {
  AllOptions options;
  return usageMessage([&] { setOption(options, name, value); });
}

AllOptions with(const char* name, const OptionValue& value) {
  AllOptions options;
  setOption(options, name, value);
  return options;
}

TEST(NamedOptions, ANameSetsAllStructsThatHaveIt) {
  const AllOptions options = with("threshold", 0.25);
  EXPECT_EQ(options.field.threshold, 0.25);
  EXPECT_EQ(options.surface.threshold, 0.25);
  EXPECT_EQ(with("thickness", int64_t(2)).grid.thickness, 2.0);
  EXPECT_EQ(with("thickness", 2.0).field.thickness, 2.0);
}

TEST(NamedOptions, TakesValuesOfEveryKind) {
  EXPECT_EQ(with("sign", "exact").surface.sign, SignMode::Exact);
  EXPECT_EQ(with("device", "vulkan:3").machine.device, "vulkan:3");
  EXPECT_TRUE(with("invert", true).field.invert);
  EXPECT_TRUE(with("invert", 1.0).field.invert);
  EXPECT_FALSE(with("close_holes", int64_t(0)).repair.closeHoles);
  EXPECT_EQ(with("passes", 7.0).field.passes, 7);
  EXPECT_EQ(with("seed", std::numeric_limits<uint64_t>::max()).samples.seed, UINT64_MAX);
  EXPECT_EQ(with("tolerance", 0.5).repair.tolerance, 0.5);
  EXPECT_EQ(with("tolerance", 0.5).simplify.tolerance, 0.5);
  EXPECT_EQ(with("inside", std::numeric_limits<double>::infinity()).band.inside,
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(with("down", std::vector{0.0, 1.0, 2.0}).repair.down, glm::dvec3(0, 1, 2));
  EXPECT_EQ(with("shape", std::vector{4.0, 5.0, 6.0}).grid.dims, glm::ivec3(4, 5, 6));
  EXPECT_EQ(with("offsets", std::vector{1.0, -2.0, 3.0, 4.0, 5.0, 6.0}).field.offsets,
            (std::vector{glm::ivec3(1, -2, 3), glm::ivec3(4, 5, 6)}));
  EXPECT_EQ(with("sigmas", std::vector{0.5, 0.25}).samples.sigmas, (std::vector{0.5, 0.25}));
  const Box box = *with("bounds", std::vector{0.0, 1.0, 2.0, 3.0, 4.0, 5.0}).grid.box;
  EXPECT_EQ(box.min, glm::dvec3(0, 1, 2));
  EXPECT_EQ(box.max, glm::dvec3(3, 4, 5));
  const Plane plane{.normal = {1, 2, 3}, .offset = 4};
  EXPECT_EQ(with("cut_plane", std::vector{1.0, 2.0, 3.0, 4.0}).render.cutPlane, plane);
}

TEST(NamedOptions, RefusesWhatMakesNoSense) {
  EXPECT_EQ(messageOf("speed", 1.0), "there is no option 'speed'");
  EXPECT_EQ(messageOf("threshold", "high"), "threshold must be a number, not 'high'");
  EXPECT_EQ(messageOf("threshold", -0.5), "threshold must be 0 or more, not -0.5");
  EXPECT_EQ(messageOf("threshold", std::numeric_limits<double>::infinity()),
            "threshold must be finite, not inf");
  EXPECT_NE(messageOf("threshold", std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_EQ(messageOf("field_of_view", 0.0), "field_of_view must be above 0, not 0");
  EXPECT_EQ(messageOf("offset", -std::numeric_limits<double>::infinity()), "offset must be finite, not -inf");
  EXPECT_EQ(messageOf("passes", 1.5), "passes must be a whole number, not 1.5");
  EXPECT_EQ(messageOf("passes", int64_t(0)), "passes must be 1 or more, not 0");
  EXPECT_EQ(messageOf("passes", int64_t(1) << 31), "passes must be 2147483647 or less, not 2147483648");
  EXPECT_EQ(messageOf("passes", std::numeric_limits<uint64_t>::max()),
            "passes must be 2147483647 or less, not 18446744073709551615");
  EXPECT_EQ(messageOf("invert", 2.0), "invert must be 0 or 1, not 2");
  EXPECT_EQ(messageOf("invert", "yes"), "invert must be a number, not 'yes'");
  EXPECT_EQ(messageOf("device", 1.0), "device must be a text, not 1");
  EXPECT_EQ(messageOf("down", std::vector{1.0}), "down must be numbers (DIRECTION), not 1 numbers");
  EXPECT_EQ(messageOf("shape", std::vector{4.0, 0.0, 6.0}), "shape must be 1 or more, not 0");
  EXPECT_EQ(messageOf("offsets", std::vector{1.0, 2.0}),
            "offsets must be numbers (X Y Z ...), not 2 numbers");
  EXPECT_EQ(messageOf("sigmas", std::vector{0.5, -1.0}), "sigmas must be 0 or more, not -1");
  EXPECT_EQ(messageOf("bounds", true), "bounds must be numbers (X0 Y0 Z0 X1 Y1 Z1), not true");
  EXPECT_NE(messageOf("sign", "left").find("harmonic"), std::string::npos);
}

TEST(NamedOptions, KindsAreThoseOfTheMembers) {
  EXPECT_EQ(optionKind("invert"), OptionKind::Flag);
  EXPECT_EQ(optionKind("resolution"), OptionKind::Whole);
  EXPECT_EQ(optionKind("seed"), OptionKind::Whole);
  EXPECT_EQ(optionKind("base"), OptionKind::Number);
  EXPECT_EQ(optionKind("device"), OptionKind::Text);
  EXPECT_EQ(optionKind("sign"), OptionKind::Choice);
  EXPECT_EQ(optionKind("bounds"), OptionKind::Numbers);
  EXPECT_EQ(usageMessage([] { optionKind("speed"); }), "there is no option 'speed'");
}

TEST(NamedOptions, EachHasAText) {
  std::set<std::string_view> named, described;
  AllOptions all;
  forEachOption(all, [&](const OptionName& option, auto&) { named.insert(option.name); });
  for (const OptionText& each : optionTexts()) {
    described.insert(each.name);
    EXPECT_TRUE(each.text.ends_with('.')) << each.name;
  }
  EXPECT_EQ(named, described);
}

}  // namespace
}  // namespace raymap
