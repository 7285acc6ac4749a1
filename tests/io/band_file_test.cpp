#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/surface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include "bands.h"
#include "error_code.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A torus with an inside, on a lattice whose sides all differ and are no multiples of a leaf's.
struct Scene {
  Mesh mesh = shapes::torus(1.0, 0.4, 40, 20);
  Grid grid = fitGrid(mesh, {.resolution = 101});
  Surface surface{mesh};
};

bool hasVdb() {
  const std::vector<std::string> extensions = fieldExtensions();
  return std::ranges::find(extensions, ".vdb") != extensions.end();
}

/// Files of each format that holds narrow bands.
class BandFiles : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  }
  fs::path path(const std::string& name) const { return folder_.path() / (name + GetParam()); }

  Scene scene_;
  TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Formats, BandFiles, testing::Values(".vdb", ".nvdb"),
                         [](const auto& info) { return info.param.substr(1); });

void expectSame(const Field& read, const Field& band) {
  EXPECT_EQ(read.grid, band.grid);
  EXPECT_EQ(read.narrow->outside, band.narrow->outside);
  EXPECT_EQ(read.narrow->inside, band.narrow->inside);
  EXPECT_EQ(read.surfaceBounds.min, band.surfaceBounds.min);
  EXPECT_EQ(read.surfaceBounds.max, band.surfaceBounds.max);
  const auto expectSameBytes = [](const auto& a, const auto& b, const char* array) {
    const auto left = std::as_bytes(std::span(a)), right = std::as_bytes(std::span(b));
    EXPECT_TRUE(std::ranges::equal(left, right)) << array << ": " << left.size() << ", " << right.size();
  };
  expectSameBytes(read.narrow->leaves, band.narrow->leaves, "leaves");
  expectSameBytes(read.narrow->tiles, band.narrow->tiles, "tiles");
  expectSameBytes(read.distance, band.distance, "distance");
  expectSameBytes(read.triangle, band.triangle, "triangle");
  expectSameBytes(read.winding, band.winding, "winding");
  expectSameBytes(read.confidence, band.confidence, "confidence");
}

/// Expects the dense field of a file to have what the band in it has. Without a leaf, numbers are 0.
void expectDense(const Field& read, const Field& band) {
  Field expected = toDense(band);
  for (Buffer<float>* numbers : {&expected.winding, &expected.confidence})
    for (float& number : *numbers)
      if (std::isnan(number)) number = 0.0F;
  EXPECT_EQ(read.grid, band.grid);
  EXPECT_EQ(read.surfaceBounds.min, band.surfaceBounds.min);
  EXPECT_EQ(read.surfaceBounds.max, band.surfaceBounds.max);
  EXPECT_EQ(read.clampDistance, band.narrow->inside == band.narrow->outside ? band.narrow->outside : 0.0);
  EXPECT_TRUE(std::ranges::equal(read.distance, expected.distance));
  EXPECT_TRUE(std::ranges::equal(read.triangle, expected.triangle));
  EXPECT_TRUE(std::ranges::equal(read.winding, expected.winding));
  EXPECT_TRUE(std::ranges::equal(read.confidence, expected.confidence));
}

TEST_P(BandFiles, KeepWhatABandHas) {
  const fs::path file = path("band");
  // The second grid cuts the torus, so that its inside reaches the lattice's end. Its spacing takes all
  // digits.
  const Grid cut{{150, 83, 37}, scene_.grid.position({-20, 40, 3}), 0.0288386};
  for (const Grid& grid : {scene_.grid, cut})
    for (const BandOptions& options :
         {BandOptions{}, BandOptions{.outside = 2.0, .inside = 4.0},
          BandOptions{.outside = 1.0, .inside = 99.0}, BandOptions{.inside = kInfinite},
          BandOptions{
              .outside = 1.0, .inside = 0.7, .triangle = true, .winding = true, .confidence = true}}) {
      const Field band = scene_.surface.generateBand(grid, options);
      writeField(file, band, {.gridName = options.triangle ? "surface" : ""});
      expectSame(readBand(file), band);
      expectDense(readField(file), band);
    }
}

TEST_P(BandFiles, HasTheSameBytesEachTime) {
  const Field band = scene_.surface.generateBand(scene_.grid, {.triangle = true});
  writeField(path("a"), band);
  writeField(folder_.path() / "b", band, {.format = GetParam()});
  EXPECT_EQ(readBytes(path("a")), readBytes(folder_.path() / "b"));
}

TEST_P(BandFiles, HasAGridOfAnyName) {
  const fs::path file = path("named");
  const Field band = scene_.surface.generateBand(scene_.grid, {.winding = true});
  writeField(file, band, {.gridName = "surface"});
  const std::string bytes = readBytes(file);
  EXPECT_NE(bytes.find("surface"), std::string::npos);
  const Field read = readField(file);
  EXPECT_EQ(read.grid, band.grid);
  EXPECT_EQ(read.winding.size(), read.distance.size());
  const Field dense = scene_.surface.generate(scene_.grid, {.band = 3.0}).field;
  writeField(file, dense, {.gridName = "surface"});
  const Field again = readField(file);
  EXPECT_TRUE(std::ranges::equal(again.distance, dense.distance));
  EXPECT_NE(usageMessage([&] { writeField(file, dense, {.gridName = "winding"}); }).find("'winding'"),
            std::string::npos);
  writeField(file, dense, {.gridName = "distance"});
  for (const FieldWriteOptions& options :
       {FieldWriteOptions{.gridName = "a"}, FieldWriteOptions{.half = true}})
    EXPECT_NE(usageMessage([&] { writeField(folder_.path() / "x.nrrd", dense, options); }).find(".vdb"),
              std::string::npos);
}

/// Returns the most that 16 bits move a number of a leaf with this range: halves in a .vdb, a 65,535th part
/// of the range in a .nvdb. Both are rounded to the nearest.
double halfError(const std::string& format, double value, double range) {
  return format == ".vdb" ? std::abs(value) / 2048.0 + 1e-7 : 1.02 * 0.5 * range / 65535.0;
}

TEST_P(BandFiles, HoldHalfFloats) {
  const fs::path whole = path("whole"), half = path("half");
  size_t even = 0;  // Leaves with one number.
  for (const BandOptions& options :
       {BandOptions{.outside = 2.0, .inside = 2.9, .triangle = true},
        BandOptions{.inside = kInfinite, .triangle = true, .winding = true, .confidence = true}}) {
    const Field band = scene_.surface.generateBand(scene_.grid, options);
    writeField(whole, band);
    writeField(half, band, {.half = true});
    EXPECT_LT(fs::file_size(half), (GetParam() == ".vdb" ? 0.8 : 0.85) * double(fs::file_size(whole)));
    const std::string bytes = readBytes(half);
    writeField(half, band, {.half = true});
    EXPECT_EQ(readBytes(half), bytes);
    const Field read = readBand(half);
    EXPECT_TRUE(std::ranges::equal(read.narrow->leaves, band.narrow->leaves));
    EXPECT_EQ(read.narrow->tiles.size(), band.narrow->tiles.size());
    EXPECT_TRUE(std::ranges::equal(read.triangle, band.triangle));
    // A .nvdb rounds neither width.
    const double rounding = GetParam() == ".vdb" ? 0.0005 : 0.0;
    EXPECT_NEAR(read.narrow->outside, band.narrow->outside, rounding * band.narrow->outside);
    EXPECT_TRUE(read.narrow->inside == band.narrow->inside ||
                std::abs(read.narrow->inside - band.narrow->inside) <= rounding * band.narrow->inside);
    EXPECT_LE(read.activeCount(), band.activeCount());
    EXPECT_GE(read.activeCount(), 0.98 * double(band.activeCount()));
    EXPECT_TRUE(std::ranges::equal(toDense(read).distance, readField(half).distance));
    for (const auto array : {&Field::distance, &Field::winding, &Field::confidence}) {
      ASSERT_EQ((read.*array).size(), (band.*array).size());
      for (size_t first = 0; first < (band.*array).size(); first += NarrowBand::kLeafSamples) {
        const std::span expected((band.*array).data() + first, NarrowBand::kLeafSamples);
        const auto [least, most] = std::ranges::minmax(expected);
        const double range = double(most) - double(least);
        even += range == 0.0 ? 1 : 0;
        for (size_t s = 0; s < expected.size(); ++s)
          ASSERT_NEAR((read.*array)[first + s], expected[s], halfError(GetParam(), expected[s], range))
              << first << ", " << s;
      }
    }
  }
  EXPECT_GT(even, 0u);
}

TEST_P(BandFiles, HoldHalfFloatsOfDenseFields) {
  const Grid coarse = fitGrid(scene_.mesh, {.resolution = 45});
  for (const double width : {3.0, 0.0}) {
    const Field dense = scene_.surface.generate(coarse, {.band = width}).field;
    writeField(path("half"), dense, {.half = true});
    const Field read = readField(path("half"));
    EXPECT_EQ(read.clampDistance, dense.clampDistance);
    const float most = std::ranges::max(dense.distance);
    for (size_t s = 0; s < dense.distance.size(); ++s)
      ASSERT_NEAR(read.distance[s], dense.distance[s], halfError(GetParam(), dense.distance[s], 2.0 * most))
          << s;
  }
}

TEST(BandFile, RefusesWhatHalfFloatsCannotHold) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "half.vdb";
  Field field{.grid = {.dims = {2, 1, 1}, .spacing = 1.0}};
  const auto fill = [&](float a, float b) {
    field.distance.resizeUninitialized(2);
    field.distance[0] = a, field.distance[1] = b;
  };
  fill(1.0F, 65472.0F);  // The largest one, 65504, is left to the background.
  writeField(path, field, {.half = true});
  EXPECT_EQ(readField(path).distance[1], 65472.0F);
  fill(-65473.0F, 1.0F);
  EXPECT_NE(usageMessage([&] { writeField(path, field, {.half = true}); }).find("65473"), std::string::npos);
  fill(1.0F, 2.0F);
  field.grid.spacing = 0.00009;
  EXPECT_NE(usageMessage([&] { writeField(path, field, {.half = true}); }).find("9e-05"), std::string::npos);
  const fs::path nano = folder.path() / "half.nvdb";
  const auto roundTrip = [&] {
    writeField(nano, field, {.half = true});
    return readField(nano);
  };
  fill(-1e38F, 1e38F);
  EXPECT_NEAR(roundTrip().distance[0], -1e38, 1e33);
  for (const float wrong : {2e38F, -INFINITY, NAN}) {
    fill(1.0F, wrong);
    EXPECT_NE(usageMessage(roundTrip).find("1e38"), std::string::npos) << wrong;
  }
}

TEST(BandFile, ReadsFieldsOfAllSamplesAsBands) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "dense.vdb";
  for (const double width : {0.0, 3.0}) {
    const Field dense =
        scene.surface.generateRegion(scene.grid, {glm::ivec3(0), scene.grid.dims}, {.band = width});
    writeField(path, dense);
    const Field read = readBand(path);
    EXPECT_TRUE(std::ranges::equal(toDense(read).distance, dense.distance)) << width;
    if (width > 0.0) expectSame(read, toSparse(dense, {.outside = width, .inside = width}));
  }
}

TEST_P(BandFiles, HoldsSeveralBands) {
  const fs::path file = path("both");
  const Field thin = scene_.surface.generateBand(scene_.grid, {.outside = 1.0, .inside = 2.0});
  const Field other = scene_.surface.generateBand({{40, 30, 20}, glm::dvec3(-1.0), 0.1});
  writeFields(file, std::array{NamedField{"thin", &thin}, NamedField{"other", &other}});
  expectSame(readBand(file, {.gridName = "thin"}), thin);
  expectSame(readBand(file, {.gridName = "other"}), other);
  EXPECT_TRUE(std::ranges::equal(readField(file, {.gridName = "thin"}).distance, toDense(thin).distance));
  std::string warning;
  const ReadOptions options{.warn = [&](const Warning& each) { warning = each.message; }};
  expectSame(readBand(file, options), other);  // The first by name.
  EXPECT_NE(warning.find("'thin'"), std::string::npos) << warning;
  warning.clear();
  EXPECT_EQ(readField(file, options).grid, other.grid);
  EXPECT_NE(warning.find("'thin'"), std::string::npos) << warning;
  const std::string unknown = usageMessage([&] { readBand(file, {.gridName = "thick"}); });
  EXPECT_NE(unknown.find("'thick'; its grids are 'other', 'thin'"), std::string::npos) << unknown;

  const NamedField one{"thin", &thin};
  for (const std::vector<NamedField>& bands :
       std::vector<std::vector<NamedField>>{{}, {one, one}, {one, {"", &other}}})
    EXPECT_NE(usageMessage([&] { writeFields(file, bands); }).find("both."), std::string::npos);
  EXPECT_EQ(codeOf([&] { writeFields(file, std::array{one}, {.gridName = "a"}); }), ErrorCode::Usage);
  const Field dense = toDense(*one.field);
  EXPECT_NE(usageMessage([&] {
              writeFields(file, std::array{NamedField{"dense", &dense}});
            }).find("is dense"),
            std::string::npos);
}

TEST_P(BandFiles, HoldsSeveralBandsWithAllArrays) {
  const fs::path file = path("both");
  const Field thin = scene_.surface.generateBand(scene_.grid, {.winding = true, .confidence = true});
  const Field other =
      scene_.surface.generateBand({{40, 30, 20}, glm::dvec3(-1.0), 0.1}, {.triangle = true, .winding = true});
  const Field plain = scene_.surface.generateBand(scene_.grid);
  writeFields(file,
              std::array{NamedField{"thin", &thin}, NamedField{"other", &other}, NamedField{"a", &plain}});
  expectSame(readBand(file, {.gridName = "thin"}), thin);
  expectSame(readBand(file, {.gridName = "other"}), other);
  expectSame(readBand(file), plain);
  const Field dense = readField(file, {.gridName = "other"});
  EXPECT_EQ(dense.winding.size(), dense.distance.size());
  EXPECT_TRUE(dense.confidence.empty());
  const Field alone = readField(file, {.gridName = "thin.winding"});
  EXPECT_TRUE(alone.distance.empty());
  EXPECT_TRUE(std::ranges::equal(alone.winding, readField(file, {.gridName = "thin"}).winding));
  const std::string same = usageMessage([&] {
    writeFields(file, std::array{NamedField{"thin", &thin}, NamedField{"thin.winding", &plain}});
  });
  EXPECT_NE(same.find("'thin.winding'"), std::string::npos) << same;
}

TEST_P(BandFiles, RefusesWhatTheFormatCannotHold) {
  if (GetParam() != ".nvdb") return;
  const Field band = scene_.surface.generateBand(scene_.grid, {.winding = true});
  const std::string longest(255, 'n');
  writeField(path("long"), band, {.gridName = longest});
  expectSame(readBand(path("long"), {.gridName = longest}), band);
  const std::string tooLong = longest + "n";
  EXPECT_NE(usageMessage([&] { writeField(path("x"), band, {.gridName = tooLong}); }).find("256"),
            std::string::npos);
  const Field plain = scene_.surface.generateBand(scene_.grid);
  const std::array bands{NamedField{longest, &band}, NamedField{"a", &plain}};
  EXPECT_NE(usageMessage([&] { writeFields(path("x"), bands); }).find("263"),
            std::string::npos);  // Of ".winding".
  EXPECT_FALSE(fs::exists(path("x")));
}

/// Returns the message of what reading a file of these bytes throws as `Error(Input)` or
/// `Error(Unsupported)`.
std::string damage(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    readBand(file);
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ErrorCode::Input || e.code() == ErrorCode::Unsupported) << e.what();
    return e.what();
  }
  return "";
}

TEST(NvdbFile, NamesTheDamage) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "damaged.nvdb";
  writeField(file, scene.surface.generateBand(fitGrid(scene.mesh, {.resolution = 20})));
  const std::string whole = readBytes(file);
  constexpr size_t kFileHeader = 16, kAbout = 176, kName = sizeof "distance",
                   kGrid = kFileHeader + kAbout + kName;
  const auto expect = [&](size_t at, const std::string& bytes, const char* message) {
    const std::string found = damage(file, std::string(whole).replace(at, bytes.size(), bytes));
    EXPECT_NE(found.find(message), std::string::npos) << at << ": " << found;
  };
  const std::string many(8, '\x7f');
  expect(7, "1", "does not begin as a file of NanoVDB");
  expect(8, many.substr(0, 4), "version");
  expect(12, many.substr(0, 2), "it ends early");  // Number of grids.
  expect(14, std::string("\2\0", 2), "Blosc");
  expect(kFileHeader, many, "two sizes");
  expect(kFileHeader, std::string(8, '\0'), "too small");
  expect(kFileHeader + 8, many, "ends early");
  expect(kFileHeader + 136, many.substr(0, 4), "ends early");  // Bytes of its name.
  expect(kGrid, "X", "does not begin as one");
  expect(kGrid + 32, many, "ends early");
  // Any bit of the transform and the nodes. Their checksum tells.
  for (const size_t at : {kGrid + 296, whole.size() / 3, 2 * whole.size() / 3})
    expect(at, std::string(1, char(whole[at] ^ 1)), "checksum");
  for (const size_t size : {kFileHeader + 3, kGrid - 1, kGrid + 5, whole.size() / 2, whole.size() - 1})
    EXPECT_NE(damage(file, whole.substr(0, size)).find("ends early"), std::string::npos) << size;
  EXPECT_NE(damage(file, whole + "more").find("ends early"), std::string::npos);
}

TEST(BandFile, RefusesWhatIsNoBand) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "winding.vdb", array = folder.path() / "array.npy";
  const Field field = toDense(scene.surface.generateBand(scene.grid, {.winding = true}));
  writeField(path, field, {.array = FieldArray::Winding});
  writeField(array, field);
  EXPECT_NE(usageMessage([&] { readBand(array); }).find(".npy holds no narrow bands"), std::string::npos);
  EXPECT_NE(usageMessage([&] { readField(array, {.gridName = "a"}); }).find("array.npy"), std::string::npos);
  EXPECT_EQ(codeOf([&] { readBand(path); }), ErrorCode::Unsupported);
}

TEST(BandFile, IsSmall) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const Field band = scene.surface.generateBand(fitGrid(scene.mesh, {.resolution = 400}));
  writeField(folder.path() / "band.vdb", band);
  // Two thirds of the samples in leaves are not active, and take a bit each.
  EXPECT_LT(fs::file_size(folder.path() / "band.vdb"), band.distance.size() * sizeof(float));
}

TEST(BandFile, RefusesOtherFormats) {
  const Scene scene;
  const TemporaryFolder folder;
  const Field band = scene.surface.generateBand(scene.grid);
  for (const char* name : {"band.nrrd", "band.npz", "band.txt"})
    EXPECT_NE(usageMessage([&] { writeField(folder.path() / name, band); }).find(name), std::string::npos);
  EXPECT_THROW(writeField(folder.path() / "missing" / "band.vdb", band), Error);
  const auto written = codeOf([&] { writeField(folder.path() / "band.vdb", band); });
  EXPECT_EQ(written, hasVdb() ? std::nullopt : std::optional(ErrorCode::Unsupported));
}

}  // namespace
}  // namespace raymap
