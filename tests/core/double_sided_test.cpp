#include "mesh/double_sided.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "base/parallel.h"
#include "broken_meshes.h"
#include "mesh/parts.h"
#include "shapes.h"

namespace raymap {
namespace {

const std::vector<glm::dvec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

DoubleSidedFaces found(std::vector<glm::uvec3> faces) {
  return findDoubleSidedFaces(makeMesh(kCorners, std::move(faces)));
}

void expectGroups(const DoubleSidedFaces& found, const std::vector<uint32_t>& firsts,
                  const std::vector<uint32_t>& others, const std::vector<uint32_t>& groupOf) {
  EXPECT_EQ(found.firsts, firsts);
  EXPECT_EQ(found.others, others);
  EXPECT_EQ(found.groupOf, groupOf);
  EXPECT_EQ(found.count(), firsts.size() + others.size());
  EXPECT_EQ(found.empty(), firsts.empty());
}

TEST(DoubleSided, IsAPairOfOppositeWindingOrders) {
  for (const glm::uvec3 reverse : {glm::uvec3{0, 2, 1}, glm::uvec3{2, 1, 0}, glm::uvec3{1, 0, 2}}) {
    expectGroups(found({{0, 1, 2}, reverse}), {0}, {1}, {0});
    expectGroups(found({reverse, {0, 1, 3}, {1, 2, 0}}), {0}, {2}, {0});
  }
  for (const glm::uvec3 same : {glm::uvec3{0, 1, 2}, glm::uvec3{1, 2, 0}, glm::uvec3{2, 0, 1}})
    expectGroups(found({{0, 1, 2}, same}), {}, {}, {});
  expectGroups(found({{0, 1, 2}, {0, 3, 1}}), {}, {}, {});
  expectGroups(found({{0, 1, 1}, {1, 0, 1}, {2, 2, 2}, {2, 2, 2}}), {}, {}, {});
}

TEST(DoubleSided, NeedsAsManyFacesOfEachOrder) {
  expectGroups(found({{0, 1, 2}, {0, 2, 1}, {1, 2, 0}}), {}, {}, {});
  expectGroups(found({{1, 2, 3}, {0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}, {3, 2, 1}}), {0, 1},
               {5, 2, 3, 4}, {0, 1, 1, 1});
}

TEST(RepeatedFaces, AreAllButOneOfAGroup) {
  const auto repeated = [](std::vector<glm::uvec3> faces) { return found(std::move(faces)).repeated; };
  using Faces = std::vector<uint32_t>;
  for (const glm::uvec3 same : {glm::uvec3{0, 1, 2}, glm::uvec3{1, 2, 0}, glm::uvec3{2, 0, 1}}) {
    EXPECT_EQ(repeated({{0, 1, 2}, same}), Faces({1}));
    EXPECT_EQ(repeated({same, {0, 1, 3}, {1, 2, 0}, {2, 0, 1}}), Faces({2, 3}));
  }
  EXPECT_EQ(repeated({{0, 1, 2}, {0, 2, 1}}), Faces());
  EXPECT_EQ(repeated({{0, 1, 2}, {0, 1, 3}}), Faces());
  EXPECT_EQ(repeated({{0, 1, 1}, {0, 1, 1}, {2, 2, 2}, {2, 2, 2}, {2, 2, 2}}), Faces());
}

TEST(RepeatedFaces, LeaveTheLowestOfTheWindingOrderOfMost) {
  using Faces = std::vector<uint32_t>;
  const glm::uvec3 one{0, 1, 2}, other{2, 1, 0};
  EXPECT_EQ(found({one, other, one}).repeated, Faces({1, 2}));
  EXPECT_EQ(found({other, one, one}).repeated, Faces({0, 2}));
  EXPECT_EQ(found({one, other, other}).repeated, Faces({0, 2}));
  EXPECT_EQ(found({other, one, one, one, other, {0, 1, 3}}).repeated, Faces({0, 2, 3, 4}));
  EXPECT_EQ(found({other, one, one, one, other, other}).repeated, Faces());
}

TEST(RepeatedFaces, AreNotThoseThatSolidsShare) {
  using Faces = std::vector<uint32_t>;
  const Mesh low = shapes::box({0, 0, 0}, {1, 1, 1}), high = shapes::box({0, 0, 0}, {1, 1, 2});
  EXPECT_EQ(findDoubleSidedFaces(shapes::joined(low, high)).repeated, Faces());
  Mesh listed = low;  // One of its faces is listed twice, beside solids that share faces.
  listed.triangles.push_back(listed.triangles[5]);
  const Mesh apart = shapes::box({5, 0, 0}, {6, 1, 1}), beside = shapes::box({5, 0, 0}, {6, 1, 2});
  EXPECT_EQ(findDoubleSidedFaces(shapes::joined(listed, shapes::joined(apart, beside))).repeated,
            Faces({12}));
  // A whole solid that is listed twice is balanced with and without the second one.
  EXPECT_EQ(findDoubleSidedFaces(shapes::joined(low, low)).repeated.size(), 12u);
}

TEST(DoubleSided, ComparesPositionsNotVertices) {
  Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}, {1, 0, 0}, {0, 1, 0}},
            .triangles = {{0, 1, 2}, {3, 5, 4}}};
  expectGroups(findDoubleSidedFaces(mesh), {0}, {1}, {0});
  Mesh turned = mesh;
  turned.triangles[1] = {5, 3, 4};
  EXPECT_EQ(findDoubleSidedFaces(turned).repeated, std::vector<uint32_t>({1}));
  mesh.vertices[4].x = std::nextafter(1.0f, 2.0f);
  expectGroups(findDoubleSidedFaces(mesh), {}, {}, {});
}

bool isRotation(const glm::uvec3& t, const std::vector<uint32_t>& corners) {
  return (t.x == corners[0] && t.y == corners[1]) || (t.y == corners[0] && t.z == corners[1]) ||
         (t.z == corners[0] && t.x == corners[1]);
}

/// Returns the same as `findDoubleSidedFaces`, by a map of all faces.
DoubleSidedFaces searched(const Mesh& mesh) {
  std::map<std::vector<uint32_t>, std::pair<std::vector<uint32_t>, int>> faces;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    std::vector<uint32_t> corners{t.x, t.y, t.z};
    std::sort(corners.begin(), corners.end());
    auto& [list, balance] = faces[corners];
    list.push_back(f);
    balance += isRotation(t, corners) ? 1 : -1;
  }
  std::map<uint32_t, std::vector<uint32_t>> groups;
  DoubleSidedFaces result;
  for (const auto& each : faces) {
    const std::vector<uint32_t>& corners = each.first;
    const std::vector<uint32_t>& list = each.second.first;
    const int balance = each.second.second;
    if (balance == 0) {
      groups[list.front()] = list;
      continue;
    }
    const auto kept = std::find_if(list.begin(), list.end(), [&](uint32_t f) {
      return isRotation(mesh.triangles[f], corners) == (balance > 0);
    });
    std::copy_if(list.begin(), list.end(), std::back_inserter(result.repeated),
                 [&](uint32_t f) { return f != *kept; });
  }
  std::ranges::sort(result.repeated);
  for (const auto& [first, group] : groups) {
    for (const uint32_t face : std::span(group).subspan(1)) {
      result.others.push_back(face);
      result.groupOf.push_back(uint32_t(result.firsts.size()));
    }
    result.firsts.push_back(first);
  }
  return result;
}

TEST(DoubleSided, AreFoundInLargeMeshesOnAnyNumberOfThreads) {
  Mesh mesh = withDoubledFaces(shapes::sphere(1.0, 7), 0.4, 1);
  mesh = withDoubledFaces(mesh, 0.05, 2);  // Some faces four times or three times.
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(3));
  const DoubleSidedFaces expected = searched(mesh);
  EXPECT_GT(expected.firsts.size(), 100000u);
  EXPECT_GT(expected.others.size(), expected.firsts.size());
  EXPECT_GT(expected.repeated.size(), 1000u);
  for (const int threads : {1, 2, 3})
    withThreads(threads, [&] {
      const DoubleSidedFaces found = findDoubleSidedFaces(mesh);
      expectGroups(found, expected.firsts, expected.others, expected.groupOf);
      EXPECT_EQ(found.repeated, expected.repeated);
    });
}

std::vector<uint32_t> allFaces(const Mesh& mesh) {
  std::vector<uint32_t> faces(mesh.triangles.size());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

TEST(Parts, AreNearPatches) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto partCount = [&](double gap, double distance) {
    Mesh moved = box;
    moved.origin.x += 1.0 + gap;
    const Mesh both = shapes::joined(box, moved);
    const Patches patches = findPatches(Model(both));
    EXPECT_EQ(patches.count, 2u);
    const std::vector<uint32_t> parts = findParts(both, allFaces(both), patches, distance);
    EXPECT_EQ(parts[0], 0u);
    return parts[1] == 0 ? 1 : 2;
  };
  for (const double distance : {0.01, 0.03, 0.1}) {
    EXPECT_EQ(partCount(0.99 * distance, distance), 1) << distance;
    EXPECT_EQ(partCount(-0.99 * distance, distance), 1) << distance;
    EXPECT_EQ(partCount(3.01 * distance, distance), 2) << distance;
  }
}

TEST(Parts, AreNearInEveryDirection) {
  // The first face spans 100 along every axis. The second one is small, and near a corner of it or not.
  const auto partCount = [&](const glm::dvec3& gap) {
    const std::vector<glm::dvec3> p{{0, 0, 0}, glm::dvec3(-100.5), {-50, -100, -100},
                                    gap,       gap + 0.001,        gap + glm::dvec3(0.001, 0, 0)};
    const Mesh mesh = makeMesh(p, {{0, 1, 2}, {3, 4, 5}});
    const Patches patches{.ids = {0, 1}, .isReversed = std::vector<uint8_t>(2), .count = 2};
    return findParts(mesh, allFaces(mesh), patches, 1.0)[1] == 0 ? 1 : 2;
  };
  for (int k = 0; k < 27; ++k) {
    const glm::dvec3 way(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (way == glm::dvec3(0.0)) continue;
    EXPECT_EQ(partCount(0.99 * way), 1) << way.x << way.y << way.z;
    EXPECT_EQ(partCount(3.01 * way), 2) << way.x << way.y << way.z;
  }
}

TEST(Parts, AreJoinedAtVertices) {
  // Each face is a patch. Vertex 6 belongs to none.
  std::vector<glm::dvec3> vertices{{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                                   {-1, 0, 0}, {0, -1, 0}, {9, 0, 0}};
  for (const double x : {9.0, 8.0}) vertices.insert(vertices.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
  const std::vector<glm::uvec3> faces{{0, 1, 2}, {0, 4, 5}, {7, 8, 9}, {3, 2, 1}, {10, 11, 12}};
  const Mesh mesh = makeMesh(vertices, faces);
  const Patches patches{.ids = {0, 1, 2, 3, 4}, .isReversed = std::vector<uint8_t>(5), .count = 5};
  EXPECT_EQ(findParts(mesh, allFaces(mesh), patches, 0.01), (std::vector<uint32_t>{0, 0, 2, 0, 4}));
  EXPECT_EQ(findParts(mesh, allFaces(mesh), patches, 1.01), (std::vector<uint32_t>{0, 0, 2, 0, 2}));
  // Without face 3, which has one vertex of face 0, patch 3 touches nothing.
  EXPECT_EQ(findParts(mesh, std::vector<uint32_t>{0, 1, 2, 4}, patches, 0.01),
            (std::vector<uint32_t>{0, 0, 2, 3, 4}));
  const Patches two{.ids = {0, 0, 1, 0, 1}, .isReversed = std::vector<uint8_t>(5), .count = 2};
  EXPECT_EQ(findParts(mesh, allFaces(mesh), two, 0.01), (std::vector<uint32_t>{0, 1}));
}

}  // namespace
}  // namespace raymap
