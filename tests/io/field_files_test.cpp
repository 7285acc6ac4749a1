#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/names.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "error_code.h"
#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

/// A grid whose sides all differ, so that exchanged axes show, with an origin off the centre and a spacing
/// that takes all digits.
Grid oddGrid() {
  return {{19, 7, 11}, {-3.25, 1e6 + 0.1, 0.7}, 1.0 / 3.0};
}

/// Returns a sphere's field with every array.
Field sphereField(const Grid& grid, double band) {
  Field field;
  field.grid = grid;
  field.clampDistance = band;
  field.surfaceBounds = {{-1e-7, 1e6 + 1.0 / 3.0, -0.1}, {2.0 / 3.0, 1e6 + 7.0, -0.1}};
  field.distance.resizeUninitialized(grid.sampleCount());
  field.triangle.resizeUninitialized(grid.sampleCount());
  field.winding.resizeUninitialized(grid.sampleCount());
  field.confidence.resizeUninitialized(grid.sampleCount());
  const glm::dvec3 centre = grid.position(0.5 * glm::dvec3(grid.dims - 1));
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i) {
        const size_t s = grid.index({i, j, k});
        const double d = glm::length(grid.position({i, j, k}) - centre) - 2.5 * grid.spacing;
        field.distance[s] = static_cast<float>(band > 0.0 ? std::clamp(d, -band, band) : d);
        field.triangle[s] = band > 0.0 && std::abs(d) >= band ? kNoTriangle : static_cast<uint32_t>(s * 7919);
        field.winding[s] = d < 0.0 ? 1.0F : static_cast<float>(0.01 * i);
        field.confidence[s] = static_cast<float>(1.0 / (1.0 + static_cast<double>(s)));
      }
  return field;
}

template <class T>
void expectSameBits(const Buffer<T>& a, const Buffer<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

class FieldFiles : public testing::TestWithParam<std::string> {
 protected:
  fs::path file(const std::string& name = "field") const { return folder_.path() / (name + GetParam()); }
  bool hasGrid() const { return GetParam() != ".npy"; }
  bool holdsAll() const { return hasGrid() && GetParam() != ".nrrd"; }
  /// Number of places in a file to damage. Each takes a process for a .vdb and a .nvdb.
  size_t places(size_t most) const { return GetParam() == ".vdb" ? 30 : GetParam() == ".nvdb" ? 12 : most; }
  void expectSameGrid(const Field& a, const Field& b) const {
    EXPECT_EQ(a.grid.dims, b.grid.dims);
    if (!hasGrid()) return;
    EXPECT_EQ(a.grid, b.grid);
    EXPECT_EQ(a.clampDistance, b.clampDistance);
    EXPECT_EQ(a.surfaceBounds.min, b.surfaceBounds.min);
    EXPECT_EQ(a.surfaceBounds.max, b.surfaceBounds.max);
  }
  std::string bytes() const { return readBytes(file()); }
  void setBytes(const std::string& content) const { std::ofstream(file(), std::ios::binary) << content; }
  TemporaryFolder folder_;
};

TEST_P(FieldFiles, KeepEveryBit) {
  std::vector<Field> fields;
  fields.push_back(sphereField(oddGrid(), 0.0));
  fields.push_back(sphereField(oddGrid(), 0.4));
  fields.push_back(sphereField({{40, 35, 50}, {-1.5, 20.0, 0.125}, 0.1}, 0.3));
  fields.push_back(sphereField({{14, 13, 12}, {}, 0.0144193}, 3 * 0.0144193));
  fields.push_back(sphereField({{1, 1, 1}, {1, 2, 3}, 0.5}, 0.0));
  Field& odd = fields.emplace_back(sphereField({{5, 4, 3}, {0, 0, 0}, 2.0}, 0.0));
  odd.distance[0] = -0.0F;
  odd.distance[7] = std::numeric_limits<float>::denorm_min();
  odd.distance[59] = -std::numeric_limits<float>::max();
  for (const Field& field : fields) {
    SCOPED_TRACE(field.grid.dims.x);
    writeField(file(), field);
    const Field back = readField(file());
    expectSameGrid(back, field);
    expectSameBits(back.distance, field.distance);
    if (!holdsAll()) continue;
    expectSameBits(back.triangle, field.triangle);
    expectSameBits(back.winding, field.winding);
    expectSameBits(back.confidence, field.confidence);
  }
}

TEST_P(FieldFiles, HaveTheSameBytesEachTime) {
  // Several leaves, whose statistics threads could add up in another order each time.
  const Field field = sphereField({{14, 13, 12}, {-0.5, -0.4, -0.3}, 0.0144193}, 0.0);
  writeField(file(), field);
  const std::string first = bytes();
  for (int time = 0; time < 12; ++time) {
    writeField(file(), field);
    ASSERT_TRUE(first == bytes()) << time;
  }
}

TEST_P(FieldFiles, KeepTheOtherArrays) {
  const Field field = sphereField(oddGrid(), 0.4);
  for (const std::string name : {"triangle", "winding", "confidence"}) {
    writeField(file(name), field, {.array = fromName<FieldArray>(name)});
    const Field back = readField(file(name));
    expectSameGrid(back, field);
    EXPECT_TRUE(back.distance.empty() || !hasGrid());
    if (name == "triangle") expectSameBits(back.triangle, field.triangle);
    if (hasGrid() && name == "winding") expectSameBits(back.winding, field.winding);
    if (hasGrid() && name == "confidence") expectSameBits(back.confidence, field.confidence);
  }
}

// A cut at the very end may remove closing marks only: every sample must then be there.
TEST_P(FieldFiles, RefuseEveryTruncationThatLosesSamples) {
  const Field field = sphereField({{6, 5, 4}, {0, 0, 0}, 1.0}, 0.0);
  writeField(file(), field);
  const std::string whole = bytes();
  for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / places(97)) {
    setBytes(whole.substr(0, length));
    try {
      expectSameBits(readField(file()).distance, field.distance);
      EXPECT_GE(length, field.distance.size() * sizeof(float));
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(file().string()), std::string::npos) << e.what();
    }
  }
}

TEST_P(FieldFiles, SurviveDamage) {
  writeField(file(), sphereField({{6, 5, 4}, {0, 0, 0}, 1.0}, 0.3));
  const std::string whole = bytes();
  for (size_t at = 0; at < whole.size(); at += 1 + whole.size() / places(211)) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    setBytes(damaged);
    for (const LevelSet as : {LevelSet::Dense, LevelSet::Narrow}) {
      if (as == LevelSet::Narrow && !GetParam().ends_with("vdb")) continue;
      try {
        const Field field = readField(file(), {.levelSet = as});  // A changed sample is no error.
        if (!field.distance.empty()) validate(field);
      } catch (const Error& e) {
        EXPECT_TRUE(std::string(e.what()).starts_with(file().string() + ": ")) << e.what();
      }
    }
  }
}

TEST_P(FieldFiles, NameWhatIsMissing) {
  Field field = sphereField(oddGrid(), 0.0);
  field.winding.release();
  EXPECT_THROW(writeField(file(), field, {.array = FieldArray::Winding}), Error);
  field.distance.resizeUninitialized(5);
  EXPECT_THROW(writeField(file(), field), Error);
  EXPECT_FALSE(fs::exists(file()));
  EXPECT_THROW(readField(file("missing")), Error);
  EXPECT_THROW(readField(folder_.path()), Error);
}

/// Replaces every occurrence of `from`.
std::string replacedAll(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string bytesOf(double value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Hides our metadata, as other programs write none.
std::string madeForeign(const std::string& vdb) {
  return replacedAll(replacedAll(vdb, "raymap_dims", "stranger_ab"), "raymap_clamp_distance",
                     "stranger_clamp_distan");
}

/// Returns a field file of text or of OpenVDB, where a length stands before each name, with the name that
/// earlier versions wrote.
std::string asWrittenBefore(const std::string& file) {
  const auto named = [](const std::string& name) { return std::string{char(name.size()), 0, 0, 0} + name; };
  return replacedAll(replacedAll(file, named("raymap_clamp_distance"), named("raymap_band")),
                     "clamp_distance", "band");
}

TEST_P(FieldFiles, NameTheArraysThatAreLeftOut) {
  if (!holdsAll()) return;
  const Field field = sphereField(oddGrid(), 0.4);
  writeField(file(), field);
  std::vector<Warning> warnings;
  const auto read = [&] {
    warnings.clear();
    return readField(file(), {.warn = [&](const Warning& warning) { warnings.push_back(warning); }});
  };
  read();
  EXPECT_TRUE(warnings.empty());
  setBytes(replacedAll(bytes(), "confidence", "temperatur"));
  const Field back = read();
  expectSameBits(back.winding, field.winding);
  EXPECT_TRUE(back.confidence.empty());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::FileContent);
  EXPECT_EQ(warnings[0].message,
            file().string() + ": it also holds 'temperatur', which a field has no place for");
  EXPECT_EQ(warnings[0].fields.file, file().string());
  setBytes(replacedAll(bytes(), "winding", "density"));
  read();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].message.find(" 'density' and 'temperatur', which"), std::string::npos)
      << warnings[0].message;
  constexpr std::string_view kBoth[] = {"density", "temperatur"};
  std::string told;
  const auto tell = [&](const Warning& warning) { told += warning.message; };
  readField(file(), {.warn = tell, .alsoRead = std::span(kBoth).first(1)});
  EXPECT_NE(told.find(" 'temperatur', which"), std::string::npos) << told;
  EXPECT_EQ(told.find("density"), std::string::npos) << told;
  told = "";
  readField(file(), {.warn = tell, .alsoRead = kBoth});
  EXPECT_EQ(told, "");
}

// Trees of OpenVDB have nodes of 128 samples a side. One of these has values inside, but none of the band.
TEST_P(FieldFiles, KeepWhatLiesFarFromTheBand) {
  Field field;
  field.grid = {{260, 5, 6}, {1, 2, 3}, 0.5};
  field.clampDistance = 1.0;
  field.distance.resizeUninitialized(field.grid.sampleCount());
  std::ranges::fill(field.distance, 1.0f);
  for (int x = 0; x < 260; ++x)
    for (int z = 0; z < 4; ++z)
      field.distance[field.grid.index({x, 1, z})] = x < 6 ? 0.25f : x >= 140 && x < 200 ? -1.0f : 1.0f;
  writeField(file(), field);
  expectSameBits(readField(file()).distance, field.distance);
}

TEST_P(FieldFiles, NameTheForeignGridsThatAreLeftOut) {
  if (GetParam() != ".vdb") return;
  writeField(file(), sphereField({{12, 12, 12}, {-1, 2, 3}, 0.5}, 0.75));
  setBytes(madeForeign(bytes()));
  std::string message;
  const Field back = readField(file(), {.warn = [&](const Warning& warning) { message = warning.message; }});
  EXPECT_NE(message.find("'confidence', 'triangle' and 'winding', which"), std::string::npos) << message;
  EXPECT_EQ(back.clampDistance, 0.75);  // It took the level set.
}

TEST_P(FieldFiles, ReadTheClampDistanceOfEarlierVersions) {
  if (GetParam() == ".npy" || GetParam() == ".npz") return;  // zip_test.cpp has the other.
  if (GetParam() == ".nvdb") return;                         // Earlier versions wrote none.
  Field field = sphereField({{12, 12, 12}, {-1, 2, 3}, 0.5}, 0.75);
  writeField(file(), field, {.array = FieldArray::Winding});
  ASSERT_NE(bytes().find("clamp_distance"), std::string::npos);
  setBytes(asWrittenBefore(bytes()));
  ASSERT_EQ(bytes().find("clamp_distance"), std::string::npos);
  EXPECT_EQ(readField(file()).clampDistance, 0.75);
  expectSameBits(readField(file()).winding, field.winding);
}

TEST_P(FieldFiles, KnowTheBandOfForeignLevelSets) {
  if (GetParam() != ".vdb") return;
  Field field = sphereField({{12, 12, 12}, {-1, 2, 3}, 0.5}, 0.75);
  for (Buffer<float>* other : {&field.winding, &field.confidence}) other->release();
  field.triangle.release();
  writeField(file(), field);
  setBytes(madeForeign(bytes()));
  const Field back = readField(file());
  EXPECT_EQ(back.clampDistance, 0.75);
  EXPECT_LT(back.grid.dims.x, 12);  // The box of the active samples.
  for (int k = 0; k < back.grid.dims.z; ++k)
    for (int j = 0; j < back.grid.dims.y; ++j)
      for (int i = 0; i < back.grid.dims.x; ++i) {
        const glm::ivec3 whole = glm::ivec3(i, j, k) + (field.grid.dims - back.grid.dims) / 2;
        EXPECT_EQ(back.distance[back.grid.index({i, j, k})], field.distance[field.grid.index(whole)]);
      }
  EXPECT_EQ(back.grid.position({0, 0, 0}), field.grid.position((field.grid.dims - back.grid.dims) / 2));

  writeField(file("again"), back);
  EXPECT_EQ(readField(file("again")).clampDistance, 0.75);
}

TEST_P(FieldFiles, SayWhatTheBackgroundMeans) {
  if (GetParam() != ".vdb") return;
  Field field;
  field.grid = {{5, 1, 1}, {0, 0, 0}, 1.0};
  field.distance.resizeUninitialized(5);
  std::iota(field.distance.begin(), field.distance.end(), 0.0F);  // The largest one is in a corner.
  writeField(file(), field);
  EXPECT_NE(bytes().find("raymap_background"), std::string::npos);
  EXPECT_NE(bytes().find("no band: more than every distance in the grid"), std::string::npos);
  setBytes(madeForeign(bytes()));
  EXPECT_EQ(readField(file()).grid.dims, field.grid.dims);  // All samples are active.

  field.clampDistance = 4.0;
  writeField(file(), field);
  EXPECT_NE(bytes().find("band: distances are clamped to this magnitude"), std::string::npos);
  EXPECT_EQ(bytes().find("no band"), std::string::npos);
  setBytes(madeForeign(bytes()));
  EXPECT_EQ(readField(file()).grid.dims, glm::ivec3(4, 1, 1));
  EXPECT_EQ(readField(file()).clampDistance, 4.0);

  field.clampDistance = 6.0;  // No sample reaches it.
  writeField(file(), field);
  setBytes(madeForeign(bytes()));
  EXPECT_EQ(readField(file()).grid.dims, field.grid.dims);
  EXPECT_EQ(readField(file()).clampDistance, 6.0);
}

// The file's numbers are changed in place, as text or as bytes. A .npz has a checksum over them. OpenVDB
// refuses them with messages of its own, and stores more than the spacing, which must agree.
TEST_P(FieldFiles, NameNumbersOfTheGridThatAreNone) {
  if (!hasGrid() || GetParam() == ".npz") return;
  const double spacing = 0.8125, y = 1234.5;
  writeField(file(), sphereField({{6, 5, 4}, {1, y, 2}, spacing}, 0.0));
  const std::string whole = bytes();
  const auto refused = [&](double number, const std::string& text, double bad, const std::string& badText) {
    setBytes(replacedAll(replacedAll(whole, bytesOf(number), bytesOf(bad)), text, badText));
    try {
      readField(file());
      ADD_FAILURE() << badText << " was read";
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ErrorCode::Input || GetParam().ends_with("vdb")) << e.what();
      return std::string(e.what()).substr(file().string().size() + 2);
    }
    return std::string();
  };
  const std::pair<double, std::string> numbers[] = {
      {NAN, "nan"}, {INFINITY, "inf"}, {-0.8125, "-0.8125"}, {1e300, "1e+300"}};
  for (const auto& [bad, text] : numbers) {
    const std::string reason = refused(spacing, "0.8125", bad, text);
    if (GetParam().ends_with("vdb")) continue;
    if (bad == 1e300)
      EXPECT_TRUE(reason.starts_with("the grid reaches to x = ")) << reason;
    else
      EXPECT_EQ(reason, "the grid's spacing is " + text + ", not a positive number");
  }
  for (const auto& [bad, text] : std::span(numbers).first(2)) {
    const std::string reason = refused(y, "1234.5", bad, text);
    EXPECT_TRUE(GetParam().ends_with("vdb") || reason == "the grid's origin is not finite: y = " + text)
        << reason;
  }
}

TEST_P(FieldFiles, AreNotWrittenWithAGridThatCannotBeRead) {
  Field field = sphereField({{6, 5, 4}, {0, 0, 0}, 1.0}, 0.0);
  for (const Grid& grid : {Grid{field.grid.dims, {0, 0, NAN}, 1.0}, Grid{field.grid.dims, {}, INFINITY}}) {
    field.grid = grid;
    EXPECT_THROW(writeField(file(), field), Error);
    EXPECT_FALSE(fs::exists(file()));
  }
}

std::string formatName(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(1);
}
INSTANTIATE_TEST_SUITE_P(Formats, FieldFiles, testing::ValuesIn(fieldExtensions()), formatName);

TEST(FieldFile, ConvertsDoublesAndBigEndian) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.nrrd";
  const double values[] = {1.5, -2.25};
  std::string raw(reinterpret_cast<const char*>(values), sizeof values);
  std::reverse(raw.begin(), raw.end());  // Big endian, in the opposite order.
  std::ofstream(path, std::ios::binary)
      << "NRRD0001\ntype: double\ndimension: 3\nsizes: 2 1 1\nendian: big\nencoding: raw\n"
      << "spacings: 2 2 2\n\n"
      << raw;
  const Field field = readField(path);
  EXPECT_EQ(field.distance[0], -2.25F);
  EXPECT_EQ(field.distance[1], 1.5F);
  EXPECT_EQ(field.grid.spacing, 2.0);
}

/// A .npy and a .npz of half floats.
class HalfFiles : public testing::TestWithParam<std::string> {
 protected:
  fs::path file(const std::string& name = "field") const { return folder_.path() / (name + GetParam()); }

 private:
  TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Formats, HalfFiles, testing::Values(".npy", ".npz"),
                         [](const auto& test) { return test.param.substr(1); });

TEST_P(HalfFiles, RoundFloatsAndKeepWholeNumbers) {
  const Field field = sphereField(oddGrid(), 0.0);
  writeField(file(), field, {.half = true});
  writeField(file("whole"), field);
  EXPECT_LT(fs::file_size(file()), 0.7 * double(fs::file_size(file("whole"))));
  const Field read = readField(file());
  for (size_t s = 0; s < field.distance.size(); ++s)
    ASSERT_NEAR(read.distance[s], field.distance[s], std::abs(field.distance[s]) / 2048.0) << s;
  EXPECT_FALSE(std::ranges::equal(read.distance, field.distance));
  if (GetParam() == ".npy") return;
  expectSameBits(read.triangle, field.triangle);
  EXPECT_EQ(read.grid, field.grid);
  for (size_t s = 0; s < field.winding.size(); ++s)
    ASSERT_NEAR(read.winding[s], field.winding[s], std::abs(field.winding[s]) / 2048.0) << s;
}

TEST_P(HalfFiles, HoldAllThatSixteenBitsHold) {
  Field field{.grid = {.dims = {6, 1, 1}, .spacing = 1.0}};
  const float values[] = {0.0F, -65504.0F, 0x1p-24F, 1.0F + 0x1p-10F, 1.0F + 0x1.1p-11F, -2.0F};
  field.distance.resizeUninitialized(6);
  std::copy(values, values + 6, field.distance.begin());
  writeField(file(), field, {.half = true});
  const Field read = readField(file());
  for (size_t s = 0; s < 6; ++s) EXPECT_EQ(read.distance[s], s == 4 ? 1.0F + 0x1p-10F : values[s]) << s;
  field.distance[1] = -65505.0F;
  EXPECT_THROW(writeField(file(), field, {.half = true}), Error);
}

TEST(HalfFile, AreReadInBothByteOrders) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.npy";
  std::string header = "{'descr': '>f2', 'fortran_order': False, 'shape': (2, 1, 1), }";
  header.resize(117, ' ');
  const std::string numbers("\x3c\x00\xc1\x00", 4);  // 1 and -2.5
  std::ofstream(path, std::ios::binary) << std::string("\x93NUMPY\x01\x00\x76\x00", 10) << header << "\n"
                                        << numbers;
  const Field field = readField(path);
  EXPECT_EQ(field.distance[0], 1.0F);
  EXPECT_EQ(field.distance[1], -2.5F);
}

TEST(HalfFile, AreRefusedByFormatsWithoutSuchAType) {
  const TemporaryFolder folder;
  const Field field = sphereField(oddGrid(), 0.0);
  for (const char* name : {"a.nrrd", "a.vti"})
    EXPECT_NE(usageMessage([&] {
                writeField(folder.path() / name, field, {.half = true});
              }).find("has no type for numbers of 16 bits"),
              std::string::npos);
}

}  // namespace
}  // namespace raymap
