#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/surface.h>

#include <algorithm>
#include <limits>

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

TEST(BandFile, KeepsWhatABandHas) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "band.vdb";
  for (const BandOptions& options : {BandOptions{}, BandOptions{.outside = 2.0, .inside = 4.0},
                                     BandOptions{.inside = std::numeric_limits<double>::infinity()},
                                     BandOptions{.triangle = true, .winding = true, .confidence = true}}) {
    const SparseField band = scene.surface.generateBand(scene.grid, options);
    writeBand(path, band);
    const Field read = readField(path);
    ASSERT_EQ(read.grid.dims, band.grid.dims);
    EXPECT_EQ(read.grid.spacing, band.grid.spacing);
    EXPECT_EQ(read.surfaceBounds.min, band.surfaceBounds.min);
    EXPECT_EQ(read.surfaceBounds.max, bounds(scene.mesh).max);
    EXPECT_EQ(read.clampDistance, options.inside == options.outside ? band.outside : 0.0);
    EXPECT_EQ(read.triangle.empty(), !options.triangle);
    EXPECT_EQ(read.winding.empty(), !options.winding);
    EXPECT_EQ(read.confidence.empty(), !options.confidence);
    const glm::ivec3 dims = read.grid.dims;
    for (size_t s = 0; s < read.distance.size(); ++s) {
      const glm::ivec3 sample(int(s) % dims.x, int(s) / dims.x % dims.y, int(s) / dims.x / dims.y);
      ASSERT_EQ(read.distance[s], band.distanceAt(sample)) << s;
      const std::optional<size_t> place = band.find(sample);
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

TEST(BandFile, HasTheSameBytesEachTime) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const SparseField band = scene.surface.generateBand(scene.grid, {.triangle = true});
  writeBand(folder.path() / "a.vdb", band);
  writeBand(folder.path() / "b", band, ".vdb");
  EXPECT_EQ(readBytes(folder.path() / "a.vdb"), readBytes(folder.path() / "b"));
}

TEST(BandFile, IsSmall) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Scene scene;
  const TemporaryFolder folder;
  const SparseField band = scene.surface.generateBand(fitGrid(scene.mesh, {.resolution = 400}));
  writeBand(folder.path() / "band.vdb", band);
  // Two thirds of the samples in leaves are not active, and take a bit each.
  EXPECT_LT(fs::file_size(folder.path() / "band.vdb"), band.distance.size() * sizeof(float));
}

TEST(BandFile, RefusesOtherFormats) {
  const Scene scene;
  const TemporaryFolder folder;
  const SparseField band = scene.surface.generateBand(scene.grid);
  for (const char* name : {"band.nrrd", "band.npz", "band.txt"}) {
    try {
      writeBand(folder.path() / name, band);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(writeBand(folder.path() / "missing" / "band.vdb", band), Error);
  if (hasVdb()) return;
  try {
    writeBand(folder.path() / "band.vdb", band);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

}  // namespace
}  // namespace raymap
