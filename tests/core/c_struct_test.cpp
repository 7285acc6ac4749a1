#include "c_api/c_struct.h"

#include <gtest/gtest.h>
#include <raymap/version.h>

#include <string>

#include "error_code.h"

// A struct of three versions of the library. The tests take the second for the present one.
struct first_version {
  size_t size;
  double a;
};
struct present_version {
  size_t size;
  double a, b;
};
struct later_version {
  size_t size;
  double a, b, c;
};

namespace raymap::c {
template <>
struct FirstVersion<present_version> {
  static constexpr const char* kName = "present_version";
  static constexpr size_t kSize = sizeof(first_version);
};
}  // namespace raymap::c

namespace raymap {
namespace {

/// Returns a caller's struct as the library sees it.
template <class Struct>
auto* seen(Struct& given) {
  return reinterpret_cast<present_version*>(&given);
}

TEST(CStruct, ReadsAnOlderOneWithDefaultsForTheRest) {
  first_version caller[2] = {{sizeof(first_version), 3.0}, {77, 7.0}};  // The second must not be read.
  const present_version known = c::read(seen(caller[0]));
  EXPECT_EQ(known.a, 3.0);
  EXPECT_EQ(known.b, 0.0);
}

TEST(CStruct, ReadsAnEqualOneWhole) {
  present_version caller{sizeof caller, 3.0, 4.0};
  const present_version known = c::read(&caller);
  EXPECT_EQ(known.a, 3.0);
  EXPECT_EQ(known.b, 4.0);
}

TEST(CStruct, ReadsANewerOneWhoseUnknownMembersAre0) {
  later_version caller{sizeof caller, 3.0, 4.0, 0.0};
  EXPECT_EQ(c::read(seen(caller)).b, 4.0);
  caller.c = 5.0;
  EXPECT_EQ(usageMessage([&] { c::read(seen(caller)); }),
            "byte 30 of a present_version is not 0, but raymap " + std::string(version().text) +
                " knows only its first 24 bytes; set newer members to 0, or use a newer library");
}

TEST(CStruct, ReadsNullAsDefaults) {
  const present_version known = c::read<present_version>(nullptr);
  EXPECT_EQ(known.a, 0.0);
  EXPECT_EQ(known.b, 0.0);
}

TEST(CStruct, RefusesSizesThatCannotBeRight) {
  for (const size_t size : {size_t(0), sizeof(first_version) - 1, size_t(65537), SIZE_MAX}) {
    present_version caller{size, 1.0, 2.0};
    const std::string expected = "the size of a present_version is " + std::to_string(size) +
                                 "; initialise it with RAYMAP_INIT(present_version)";
    EXPECT_EQ(usageMessage([&] { c::read(&caller); }).find(expected), 0u);
    EXPECT_EQ(caller.a, 1.0);
  }
}

TEST(CStruct, IsInitialisedInCppToo) {
  const auto arrays = RAYMAP_INIT(raymap_mesh_arrays);
  EXPECT_EQ(arrays.size, sizeof(raymap_mesh_arrays));
  EXPECT_EQ(arrays.vertices, nullptr);
}

}  // namespace
}  // namespace raymap
