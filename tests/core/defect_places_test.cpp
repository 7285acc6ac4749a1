#include <gtest/gtest.h>
#include <raymap/diagnostics.h>

#include <algorithm>

#include "testing/shapes.h"

namespace raymap {
namespace {

/// Returns the only kind of defects of a mesh.
DefectList onlyKind(const Mesh& mesh, std::string_view name) {
  const std::vector<DefectList> kinds = findDefectPlaces(mesh);
  EXPECT_EQ(kinds.size(), 1u);
  if (kinds.empty()) return {};
  EXPECT_EQ(kinds[0].name, name);
  return kinds[0];
}

TEST(DefectPlaces, AreNoneInASphere) {
  EXPECT_TRUE(findDefectPlaces(shapes::sphere(1.0, 3)).empty());
}

TEST(DefectPlaces, ListHolesTheLongestFirst) {
  Mesh mesh = shapes::sphere(1.0, 3, {5.0, 6.0, 7.0});
  const Mesh whole = mesh;
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return whole.vertices[t.x].z > 0.7f || (t.x == whole.triangles[0].x && whole.vertices[t.x].z < 0.5f);
  });
  const DefectList holes = onlyKind(mesh, "Holes");
  ASSERT_EQ(holes.places.size(), 2u);
  EXPECT_EQ(holes.defect, Defect::Hole);
  EXPECT_TRUE(holes.faces.empty());
  EXPECT_EQ(holes.count(), holes.edges.size());
  EXPECT_EQ(holes.count(), holes.places[0].count + holes.places[1].count);
  EXPECT_GT(holes.places[0].diameter, holes.places[1].diameter);
  EXPECT_NEAR(glm::distance(holes.places[0].centre, glm::dvec3(5.0, 6.0, 7.7)), 0.0, 0.1);
  EXPECT_NEAR(holes.places[0].diameter, 1.5, 0.2);
}

TEST(DefectPlaces, GroupFacesThatTouch) {
  Mesh mesh = shapes::sphere(1.0, 3);
  for (glm::uvec3& t : mesh.triangles) {
    const float z = mesh.vertices[t.x].z;
    if (z > 0.8f || z < -0.9f) std::swap(t.x, t.y);
  }
  const DefectList flipped = onlyKind(mesh, "Flipped faces");
  ASSERT_EQ(flipped.places.size(), 2u);
  EXPECT_EQ(flipped.defect, Defect::FlippedFace);
  EXPECT_TRUE(flipped.edges.empty());
  for (const uint32_t face : flipped.faces)
    EXPECT_GT(std::abs(mesh.vertices[mesh.triangles[face].x].z), 0.7f) << face;
  EXPECT_GT(flipped.places[0].count, flipped.places[1].count);
  EXPECT_EQ(flipped.count(), flipped.places[0].count + flipped.places[1].count);
  EXPECT_NEAR(flipped.places[0].centre.z, 0.9, 0.1);
  EXPECT_NEAR(flipped.places[1].centre.z, -0.95, 0.1);
  EXPECT_NEAR(flipped.places[0].centre.x, 0.0, 0.1);
  EXPECT_GT(flipped.places[0].diameter, 1.2);
}

TEST(DefectPlaces, NameEveryKind) {
  const Mesh crossing =
      shapes::joined(shapes::sphere(1.0, 2), shapes::box({-0.3, -0.3, 0.5}, {0.3, 0.35, 2.0}));
  const DefectList crossed = onlyKind(crossing, "Faces that cross others");
  EXPECT_EQ(crossed.defect, Defect::CrossedFace);
  EXPECT_TRUE(crossed.complete);
  ASSERT_EQ(crossed.places.size(), 2u);  // Those of the sphere and those of the box share no position.

  Mesh sliver = shapes::sphere(1.0, 2);
  const glm::uvec3 first = sliver.triangles[0];
  sliver.triangles.push_back({first.x, first.x, first.x});
  const DefectList degenerate = onlyKind(sliver, "Degenerate faces");
  ASSERT_EQ(degenerate.places.size(), 1u);
  EXPECT_EQ(degenerate.faces, std::vector{uint32_t(sliver.triangles.size() - 1)});
  EXPECT_EQ(degenerate.places[0].diameter, 0.0);
  EXPECT_EQ(degenerate.places[0].centre, glm::dvec3(sliver.vertices[first.x]));

  Mesh doubled = shapes::sphere(1.0, 2);
  doubled.triangles.push_back(doubled.triangles[7]);
  doubled.triangles.push_back({first.y, first.x, first.z});
  std::vector<std::string_view> names;
  for (const DefectList& kind : findDefectPlaces(doubled)) names.push_back(kind.name);
  for (const char* name : {"Edges with more than two faces", "Duplicate faces", "Double-sided faces"})
    EXPECT_EQ(std::ranges::count(names, name), 1) << name;
}

}  // namespace
}  // namespace raymap
