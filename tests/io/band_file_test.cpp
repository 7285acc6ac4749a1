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
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

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

TEST_P(BandFiles, KeepsWhatABandHas) {
  const fs::path file = path("band");
  for (const BandOptions& options : {BandOptions{}, BandOptions{.outside = 2.0, .inside = 4.0},
                                     BandOptions{.inside = std::numeric_limits<double>::infinity()},
                                     BandOptions{.triangle = true, .winding = true, .confidence = true}}) {
    const Field band = scene_.surface.generateBand(scene_.grid, options);
    writeField(file, band);
    const Field read = readField(file);
    ASSERT_EQ(read.grid.dims, band.grid.dims);
    EXPECT_EQ(read.grid.spacing, band.grid.spacing);
    EXPECT_EQ(read.surfaceBounds.min, band.surfaceBounds.min);
    EXPECT_EQ(read.surfaceBounds.max, bounds(scene_.mesh).max);
    EXPECT_EQ(read.clampDistance, options.inside == options.outside ? band.narrow->outside : 0.0);
    EXPECT_EQ(read.triangle.empty(), !options.triangle);
    EXPECT_EQ(read.winding.empty(), !options.winding);
    EXPECT_EQ(read.confidence.empty(), !options.confidence);
    const glm::ivec3 dims = read.grid.dims;
    for (size_t s = 0; s < read.distance.size(); ++s) {
      const glm::ivec3 sample(int(s) % dims.x, int(s) / dims.x % dims.y, int(s) / dims.x / dims.y);
      ASSERT_EQ(read.distance[s], band.distanceAt(sample)) << s;
      const std::optional<size_t> place = band.narrow->find(sample);
      if (options.triangle) {
        ASSERT_EQ(read.triangle[s], place ? band.triangle[*place] : kNoTriangle) << s;
      }
      if (options.winding) {
        ASSERT_EQ(read.winding[s], place ? band.winding[*place] : 0.0F) << s;
        ASSERT_EQ(read.confidence[s], place ? band.confidence[*place] : 0.0F) << s;
      }
    }
  }
}

TEST_P(BandFiles, HasTheSameBytesEachTime) {
  const Field band = scene_.surface.generateBand(scene_.grid, {.triangle = true});
  writeField(path("a"), band);
  writeField(folder_.path() / "b", band, {.format = GetParam()});
  EXPECT_EQ(readBytes(path("a")), readBytes(folder_.path() / "b"));
}

/// Returns the message of what writing throws as `Error(Usage)`.
template <class Write>
std::string whyRefused(Write&& write) {
  try {
    write();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::Usage);
    return e.what();
  }
  return "";
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
  EXPECT_NE(whyRefused([&] { writeField(file, dense, {.gridName = "winding"}); }).find("'winding'"),
            std::string::npos);
  writeField(file, dense, {.gridName = "distance"});
  for (const FieldWriteOptions& options :
       {FieldWriteOptions{.gridName = "a"}, FieldWriteOptions{.half = true}})
    EXPECT_NE(whyRefused([&] { writeField(folder_.path() / "x.nrrd", dense, options); }).find(".vdb"),
              std::string::npos);
}

/// Returns the most that 16 bits move a number of a leaf with this range: halves in a .vdb, a 65,535th part
/// of the range in a .nvdb. Both are rounded to the nearest.
double halfError(const std::string& format, double value, double range) {
  return format == ".vdb" ? std::abs(value) / 2048.0 + 1e-7 : 1.02 * 0.5 * range / 65535.0;
}

TEST_P(BandFiles, HoldsHalfFloats) {
  const fs::path whole = path("whole"), half = path("half");
  const Field band = scene_.surface.generateBand(scene_.grid, {.triangle = true});
  writeField(whole, band);
  writeField(half, band, {.half = true});
  EXPECT_LT(fs::file_size(half), (GetParam() == ".vdb" ? 0.8 : 0.85) * double(fs::file_size(whole)));
  const Field exact = readField(whole), rounded = readField(half);
  EXPECT_EQ(rounded.clampDistance, exact.clampDistance);
  EXPECT_TRUE(std::ranges::equal(rounded.triangle, exact.triangle));
  for (size_t s = 0; s < exact.distance.size(); ++s)
    ASSERT_NEAR(rounded.distance[s], exact.distance[s],
                halfError(GetParam(), exact.distance[s], band.narrow->outside + band.narrow->inside))
        << s;
  const Grid coarse = fitGrid(scene_.mesh, {.resolution = 45});
  for (const double width : {3.0, 0.0}) {
    const Field dense = scene_.surface.generate(coarse, {.band = width}).field;
    writeField(half, dense, {.half = true});
    const Field read = readField(half);
    EXPECT_EQ(read.clampDistance, dense.clampDistance);
    const float most = std::ranges::max(dense.distance);
    for (size_t s = 0; s < dense.distance.size(); ++s)
      ASSERT_NEAR(read.distance[s], dense.distance[s], halfError(GetParam(), dense.distance[s], 2.0 * most))
          << s;
  }
}

TEST_P(BandFiles, HoldsHalfFloatsOfEachArray) {
  const Field band =
      scene_.surface.generateBand(scene_.grid, {.triangle = true, .winding = true, .confidence = true});
  writeField(path("a"), band, {.half = true});
  writeField(path("b"), band, {.half = true});
  EXPECT_EQ(readBytes(path("a")), readBytes(path("b")));
  const Field read = readBand(path("a"));
  EXPECT_TRUE(std::ranges::equal(read.narrow->leaves, band.narrow->leaves));
  EXPECT_TRUE(std::ranges::equal(read.triangle, band.triangle));
  size_t even = 0;  // Leaves with one confidence.
  for (size_t leaf = 0; leaf < band.narrow->leaves.size(); ++leaf)
    for (const auto array : {&Field::distance, &Field::winding, &Field::confidence}) {
      const std::span expected((band.*array).data() + leaf * NarrowBand::kLeafSamples,
                               NarrowBand::kLeafSamples);
      const float* found = (read.*array).data() + leaf * NarrowBand::kLeafSamples;
      const auto [least, most] = std::ranges::minmax(expected);
      even += least == most ? 1 : 0;
      for (size_t s = 0; s < expected.size(); ++s)
        ASSERT_NEAR(found[s], expected[s], halfError(GetParam(), expected[s], double(most) - double(least)))
            << leaf << ", " << s;
    }
  EXPECT_GT(even, 0u);
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
  EXPECT_NE(whyRefused([&] { writeField(path, field, {.half = true}); }).find("65473"), std::string::npos);
  fill(1.0F, 2.0F);
  field.grid.spacing = 0.00009;
  EXPECT_NE(whyRefused([&] { writeField(path, field, {.half = true}); }).find("9e-05"), std::string::npos);
  const fs::path nano = folder.path() / "half.nvdb";
  const auto roundTrip = [&] {
    writeField(nano, field, {.half = true});
    return readField(nano);
  };
  fill(-1e38F, 1e38F);
  EXPECT_NEAR(roundTrip().distance[0], -1e38, 1e33);
  for (const float wrong : {2e38F, -INFINITY, NAN}) {
    fill(1.0F, wrong);
    EXPECT_NE(whyRefused(roundTrip).find("1e38"), std::string::npos) << wrong;
  }
}

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

TEST_P(BandFiles, ComesBackAsABand) {
  const fs::path file = path("band");
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  // The second grid cuts the torus, so that its inside reaches the lattice's end.
  const Grid cut{{150, 83, 37}, scene_.grid.position({-20, 40, 3}), scene_.grid.spacing};
  for (const Grid& grid : {scene_.grid, cut})
    for (const BandOptions& options :
         {BandOptions{}, BandOptions{.outside = 2.0, .inside = 4.0},
          BandOptions{.outside = 1.0, .inside = 99.0}, BandOptions{.inside = kInfinite},
          BandOptions{
              .outside = 1.0, .inside = 0.7, .triangle = true, .winding = true, .confidence = true}}) {
      const Field band = scene_.surface.generateBand(grid, options);
      writeField(file, band, {.gridName = options.triangle ? "surface" : ""});
      expectSame(readBand(file), band);
    }
}

TEST_P(BandFiles, ComesBackFromHalfFloats) {
  const fs::path half = path("half");
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double inside : {2.9, kInfinite}) {
    const Field band =
        scene_.surface.generateBand(scene_.grid, {.outside = 2.0, .inside = inside, .triangle = true});
    writeField(half, band, {.half = true});
    const Field read = readBand(half);
    const Field dense = readField(half);
    EXPECT_TRUE(std::ranges::equal(read.narrow->leaves, band.narrow->leaves));
    EXPECT_EQ(read.narrow->tiles.size(), band.narrow->tiles.size());
    EXPECT_TRUE(std::ranges::equal(read.triangle, band.triangle));
    // A .nvdb rounds neither width.
    const double rounding = GetParam() == ".vdb" ? 0.0005 : 0.0;
    EXPECT_NEAR(read.narrow->outside, band.narrow->outside, rounding * band.narrow->outside);
    if (inside < kInfinite) {
      EXPECT_NEAR(read.narrow->inside, band.narrow->inside, rounding * band.narrow->inside);
    }
    EXPECT_LE(read.activeCount(), band.activeCount());
    EXPECT_GE(read.activeCount(), 0.98 * double(band.activeCount()));
    EXPECT_TRUE(std::ranges::equal(toDense(read).distance, dense.distance));
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
  const std::string unknown = whyRefused([&] { readBand(file, {.gridName = "thick"}); });
  EXPECT_NE(unknown.find("'thick'; its grids are 'other', 'thin'"), std::string::npos) << unknown;

  const NamedField one{"thin", &thin};
  for (const std::vector<NamedField>& bands :
       std::vector<std::vector<NamedField>>{{}, {one, one}, {one, {"", &other}}})
    EXPECT_NE(whyRefused([&] { writeFields(file, bands); }).find("both."), std::string::npos);
  EXPECT_NE(whyRefused([&] { writeFields(file, std::array{one}, {.gridName = "a"}); }), "");
  const Field dense = toDense(*one.field);
  EXPECT_NE(whyRefused([&] {
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
  const std::string same = whyRefused([&] {
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
  EXPECT_NE(whyRefused([&] { writeField(path("x"), band, {.gridName = tooLong}); }).find("256"),
            std::string::npos);
  const Field plain = scene_.surface.generateBand(scene_.grid);
  const std::array bands{NamedField{longest, &band}, NamedField{"a", &plain}};
  EXPECT_NE(whyRefused([&] { writeFields(path("x"), bands); }).find("263"),
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
  EXPECT_NE(whyRefused([&] { readBand(array); }).find(".npy holds no narrow bands"), std::string::npos);
  EXPECT_NE(whyRefused([&] { readField(array, {.gridName = "a"}); }).find("array.npy"), std::string::npos);
  try {
    readBand(path);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::Unsupported);
    EXPECT_NE(std::string(e.what()).find("'winding' is no level set"), std::string::npos) << e.what();
  }
}

TEST_P(BandFiles, AnyWordChanged) {
  const fs::path file = path("damaged");
  writeField(file, scene_.surface.generateBand(fitGrid(scene_.mesh, {.resolution = 20})));
  const std::string whole = readBytes(file);
  size_t refused = 0;
  for (size_t at = 0; at + 4 < whole.size(); at += 1 + whole.size() / 8)
    for (const std::string& word : {std::string(4, '\xff'), std::string("text")}) {
      std::ofstream(file, std::ios::binary) << std::string(whole).replace(at, word.size(), word);
      try {
        validate(readBand(file));
      } catch (const Error& e) {
        EXPECT_TRUE(e.code() == ErrorCode::Input || e.code() == ErrorCode::Unsupported) << e.what();
        EXPECT_TRUE(std::string(e.what()).starts_with(file.string() + ": ")) << e.what();
        ++refused;
      }
    }
  EXPECT_GT(refused, 3u);
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
  for (const char* name : {"band.nrrd", "band.npz", "band.txt"}) {
    try {
      writeField(folder.path() / name, band);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(writeField(folder.path() / "missing" / "band.vdb", band), Error);
  if (hasVdb()) return;
  try {
    writeField(folder.path() / "band.vdb", band);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

}  // namespace
}  // namespace raymap
