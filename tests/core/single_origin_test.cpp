// Which origin a mesh has: positions that single precision can hold about one stay bit for bit.

#include "mesh/single_origin.h"

#include <gtest/gtest.h>
#include <raymap/mesh_view.h>

#include <cmath>
#include <random>

#include "mesh/model.h"

namespace raymap {
namespace {

TEST(RoundedMiddle, IsAMultipleOfTheStep) {
  // Half of the interval is 0.11, from 2^-4 on: steps of 2^-20.
  EXPECT_EQ(roundedMiddle(0.0, 0.22), std::round(0.11 * 0x1p20) * 0x1p-20);
  EXPECT_EQ(roundedMiddle(-1.0, 1.0), 0.0);
  EXPECT_EQ(roundedMiddle(2.0, 4.0), 3.0);
  EXPECT_EQ(roundedMiddle(0.3, 0.3), 0.3) << "of a point";
  EXPECT_FALSE(std::signbit(roundedMiddle(-1.0 - 0x1p-30, 1.0)));
  EXPECT_EQ(roundedMiddle(-1e-320, 1e-320), 0.0) << "steps that underflow";
}

TEST(KeptAbout, IsWhatSinglePrecisionHolds) {
  EXPECT_TRUE(isKeptAbout(0.0, double(0.1F)));
  EXPECT_FALSE(isKeptAbout(0.0, 0.1));
  EXPECT_TRUE(isKeptAbout(0.1, 0.1));
  EXPECT_FALSE(isKeptAbout(0.5, double(0.1F)));
}

/// Returns the mesh of one triangle per three positions.
Mesh meshOf(const std::vector<glm::dvec3>& positions) {
  std::vector<glm::uvec3> triangles;
  for (uint32_t v = 0; v + 2 < positions.size(); v += 3) triangles.emplace_back(v, v + 1, v + 2);
  return makeMesh(positions, triangles);
}

TEST(SingleOrigin, KeepsZero) {
  const Mesh slab = meshOf({{-1.7, -0.25, 0}, {0.3, 0.25, 0}, {0.3, 0.25, 0.22}});
  for (uint32_t v = 0; v < 2; ++v) EXPECT_EQ(slab.position(v).z, 0.0);
  EXPECT_EQ(bounds(slab).min.z, 0.0);
  EXPECT_NEAR(slab.position(2).z, 0.22, 0.11 * 0x1p-24);
}

TEST(SingleOrigin, LosesNoiseAboutZeroIfAsked) {
  // 0.5 keeps multiples of 2^-25, and 0 all floats.
  const auto originOf = [](float low, double noise) {
    const std::vector<glm::vec3> at{{0, 0, low}, {1, 0, 0}, {0, 1, 1}};
    const auto position = [&](size_t v) { return at[v]; };
    return singleOrigin({{0, 0, 0}, {1, 1, 1}}, 3, position, nullptr, noise).z;
  };
  EXPECT_EQ(originOf(0x1p-41F, 0x1p-40), 0.5);
  EXPECT_EQ(originOf(0x1p-40F, 0x1p-40), 0.5);
  EXPECT_EQ(originOf(0x1p-39F, 0x1p-40), 0.0);
  EXPECT_EQ(originOf(0x1p-41F, 0.0), 0.0);
  EXPECT_EQ(originOf(0.0F, 0x1p-40), 0.5);
}

TEST(SingleOrigin, IsTheCentreWhereThatKeepsAll) {
  EXPECT_EQ(meshOf({{0, 0, 0}, {1, 3, 0}, {0, 0, 0.5}}).origin, glm::dvec3(0.5, 1.5, 0.25));
  // The centre 2.25 keeps all; its rounding and 0 would, too.
  EXPECT_EQ(meshOf({{1.5, 0, 0}, {3, 1, 0}, {2, 0, 1}}).origin.x, 2.25);
}

TEST(SingleOrigin, IsRoundedWhereTheCentreLosesBits) {
  // The middle of floats has a bit more than they have.
  const double low = 500000.03125, high = 500001.0;
  const Mesh far = meshOf({{low, 0, 0}, {high, 1, 0}, {500000.5, 0, 1}});
  EXPECT_EQ(far.position(0).x, low);
  EXPECT_EQ(far.position(1).x, high);
  EXPECT_LT(std::abs(far.vertices[0].x), 1.0F) << "not about 0, where sums lose digits";
}

TEST(SingleOrigin, IsZeroForFloatsOfAllSizes) {
  const Mesh mesh = meshOf({{double(1e-12F), 1, 0}, {double(0.1F), 3, 0}, {1, 2, 1}});
  EXPECT_EQ(mesh.origin.x, 0.0);
  EXPECT_EQ(mesh.origin.y, 2.0) << "each axis by itself";
  EXPECT_EQ(mesh.position(0).x, double(1e-12F));
}

TEST(SingleOrigin, KeepsAllFloatsAndIsNoWorseThanPromised) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const double scale = std::pow(10.0, trial % 20 - 10), offset = trial % 3 * std::pow(10.0, trial % 7);
    std::normal_distribution<double> distribution(offset, scale);
    std::vector<glm::dvec3> positions(99);
    for (glm::dvec3& p : positions)
      p = glm::dvec3(glm::vec3(distribution(random), distribution(random), distribution(random)));
    const Mesh mesh = meshOf(positions);
    const glm::dvec3 half = 0.5 * bounds(mesh).size();
    for (uint32_t v = 0; v < positions.size(); ++v) {
      ASSERT_EQ(mesh.position(v), positions[v]) << trial;
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_LE(std::abs(mesh.vertices[v][axis]), 3.001 * half[axis]) << trial;
    }
  }
}

TEST(SingleOrigin, IsTheCentreWhereTheRoundedOneKeepsNoMore) {
  const Mesh none = meshOf({{0.123456789012, 0, 0}, {1.1234567890123, 1, 0}, {0.5432109876543, 0, 1}});
  EXPECT_EQ(none.origin.x, 0.5 * (0.123456789012 + 1.1234567890123));
  const Mesh more = meshOf({{0.123456789012, 0, 0}, {1.1234567890123, 1, 0}, {0.5, 0, 1}});
  EXPECT_EQ(more.origin.x, roundedMiddle(0.123456789012, 1.1234567890123));
  EXPECT_EQ(more.position(2).x, 0.5);
}

TEST(SingleOrigin, LosesAHalfOfTheLastBitOfOthers) {
  std::mt19937 random(2);
  std::normal_distribution<double> distribution(0.37, 1.0);
  std::vector<glm::dvec3> positions(99);
  for (glm::dvec3& p : positions) p = {distribution(random), distribution(random), distribution(random)};
  const Mesh mesh = meshOf(positions);
  const glm::dvec3 half = 0.5 * bounds(mesh).size();
  for (uint32_t v = 0; v < positions.size(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_LE(std::abs(mesh.position(v)[axis] - positions[v][axis]), half[axis] * 1.0001 * 0x1p-24);
}

TEST(SingleOrigin, PrefersTheOneThatIsKnown) {
  const std::vector<double> x{0.1, 1.1};
  const auto at = [&](size_t v) { return glm::dvec3(x[v], 0, 0); };
  const Box box{{0.1, 0, 0}, {1.1, 0, 0}};
  const glm::dvec3 known(0.1, 7, 7), useless(0.2, 0, 0), far(0.0, 0, 0);
  const auto floats = [](size_t v) { return glm::dvec3(v == 0 ? 500000.03125 : 500001.0, 0, 0); };
  EXPECT_NE(singleOrigin({{500000.03125, 0, 0}, {500001, 0, 0}}, 2, floats, &far).x, 0.0) << "far off";
  EXPECT_EQ(singleOrigin(box, 2, at, &known).x, 0.1);
  EXPECT_EQ(singleOrigin(box, 2, at, &useless).x, singleOrigin(box, 2, at).x);
}

TEST(SingleOrigin, IgnoresPositionsBeyondTheBox) {
  const std::vector<double> x{0.0, 1.0, 0.1, 100.1, NAN};
  const auto at = [&](size_t v) { return glm::dvec3(x[v], 0, 0); };
  EXPECT_EQ(singleOrigin({{0, 0, 0}, {1, 0, 0}}, 2, at).x, 0.5);
  EXPECT_NE(singleOrigin({{0, 0, 0}, {1.1, 0, 0}}, 3, at).x, 0.55);
  EXPECT_EQ(singleOrigin({{0.5, 0, 0}, {1, 0, 0}}, 5, at).x, 0.75);
  EXPECT_EQ(singleOrigin(Box{}, 5, at), glm::dvec3(0.0));
}

TEST(SingleOrigin, OfAViewIsThatOfItsMesh) {
  const std::vector<glm::dvec3> positions{{-1.7, -0.25, 0}, {0.3, 0.25, 0}, {0.3, 0.25, 0.22}};
  const std::vector<glm::uvec3> triangles{{0, 1, 2}};
  const Mesh mesh = makeMesh(positions, triangles);
  const MeshView view(positions, triangles);
  const Model packed(view);
  EXPECT_EQ(packed.origin, mesh.origin);
  EXPECT_TRUE(std::equal(packed.vertices.begin(), packed.vertices.end(), mesh.vertices.begin()));
  EXPECT_EQ(bounds(view), bounds(mesh));
}

}  // namespace
}  // namespace raymap
