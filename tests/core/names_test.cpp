#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <string>

namespace raymap {
namespace {

template <class Enum>
class NamesOf : public testing::Test {};
using Enums = testing::Types<DistanceMode, SignMode, Sampling, Orientation, FieldArray, FieldForm, DeviceType,
                             DeviceTestState, ErrorCode, MeshKind, Arrangement, Part, Remedy, WarningCode>;
TYPED_TEST_SUITE(NamesOf, Enums);

TYPED_TEST(NamesOf, GoBothWays) {
  EXPECT_FALSE(names<TypeParam>().empty());
  for (const std::string_view text : names<TypeParam>()) EXPECT_EQ(name(fromName<TypeParam>(text)), text);
}

TYPED_TEST(NamesOf, AreListedWhereOneIsUnknown) {
  for (const char* unknown : {"", "Exact", "exact "}) try {
      fromName<TypeParam>(unknown);
      FAIL() << unknown;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      for (const std::string_view text : names<TypeParam>())
        EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
}

TEST(Names, AreThoseOfTheCommandLine) {
  EXPECT_EQ(name(DistanceMode::Neighbours), "neighbours");
  EXPECT_EQ(name(SignMode::Ray), "ray");
  EXPECT_EQ(name(SignMode::None), "none");
  EXPECT_EQ(name(Sampling::Paper), "paper");
  EXPECT_EQ(name(Orientation::Repair), "repair");
  EXPECT_EQ(name(FieldArray::Triangle), "triangle");
  EXPECT_EQ(name(DeviceType::Software), "software");
  EXPECT_EQ(name(DeviceTestState::Unfinished), "unfinished");
  EXPECT_EQ(name(Part::Buried), "buried");
  EXPECT_EQ(name(ErrorCode::DeviceLost), "device_lost");
  EXPECT_EQ(name(ErrorCode::DeviceMemory), "device_memory");
  EXPECT_EQ(name(WarningCode::DrainHolesMissing), "drain_holes_missing");
  EXPECT_EQ(name(WarningCode::TrianglesMissed), "triangles_missed");
  EXPECT_EQ(name(WarningCode::NothingInside), "nothing_inside");
  EXPECT_EQ(name(WarningCode::FarVertices), "far_vertices");
  EXPECT_EQ(names<SignMode>().size(), 7u);
  EXPECT_THROW(name(static_cast<SignMode>(77)), Error);
}

TEST(Version, IsThatOfTheHeaders) {
  EXPECT_EQ(std::string(version().text), std::to_string(RAYMAP_VERSION_MAJOR) + "." +
                                             std::to_string(RAYMAP_VERSION_MINOR) + "." +
                                             std::to_string(RAYMAP_VERSION_PATCH));
  EXPECT_EQ(version().minor, RAYMAP_VERSION_MINOR);
}

}  // namespace
}  // namespace raymap
