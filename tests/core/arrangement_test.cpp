#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/error.h>

#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::inverted;
using shapes::joined;

Arrangement arranged(const Mesh& mesh, const MachineOptions& machine = {}) {
  return arrangeParts(mesh, diagnose(mesh, {.brief = true}), findSelfIntersections(mesh), machine);
}

Mesh cube(double low, double high) {
  return box(glm::dvec3(low), glm::dvec3(high));
}

TEST(Arrangement, TellsSeparateFromNestedParts) {
  EXPECT_EQ(arranged(cube(0, 10)), Arrangement::Separate);
  EXPECT_EQ(arranged(joined(cube(0, 10), cube(11, 12))), Arrangement::Separate);
  const Mesh hollow = joined(cube(0, 10), inverted(cube(2, 8)));
  EXPECT_EQ(arranged(hollow), Arrangement::Nested);
  EXPECT_EQ(arranged(joined(hollow, cube(3, 4))), Arrangement::Nested);
  EXPECT_EQ(arranged(joined(hollow, cube(20, 21))), Arrangement::Nested);
}

TEST(Arrangement, FindsPartsThatFaceTheWrongWay) {
  EXPECT_EQ(arranged(joined(cube(0, 10), cube(2, 8))), Arrangement::Misnested);
  EXPECT_EQ(arranged(inverted(cube(0, 10))), Arrangement::Misnested);
  EXPECT_EQ(arranged(joined(cube(0, 10), inverted(cube(11, 12)))), Arrangement::Misnested);
  const Mesh hollow = joined(cube(0, 10), inverted(cube(2, 8)));
  EXPECT_EQ(arranged(joined(hollow, inverted(cube(3, 4)))), Arrangement::Misnested);
}

TEST(Arrangement, FindsPartsThatTouch) {
  EXPECT_EQ(arranged(joined(cube(0, 10), box({10, 1, 0}, {20, 11, 10}))), Arrangement::Touching);
  EXPECT_EQ(arranged(joined(cube(0, 10), box({10, 3, 4}, {20, 5, 6}))), Arrangement::Touching);
  EXPECT_EQ(arranged(joined(cube(0, 10), box({10.01, 3, 4}, {20, 5, 6}))), Arrangement::Separate);
  // A cavity that reaches the wall of its solid.
  EXPECT_EQ(arranged(joined(cube(0, 10), inverted(box({4, 4, 0}, {6, 6, 5})))), Arrangement::Touching);
  // They meet in a corner or an edge of one only: no face of theirs overlaps.
  EXPECT_EQ(arranged(joined(cube(0, 10), cube(10, 20))), Arrangement::Separate);
}

TEST(Arrangement, FindsPartsThatOverlap) {
  EXPECT_EQ(arranged(joined(cube(0, 10), cube(5, 15))), Arrangement::Overlapping);
  // All faces of these are parallel or touch: none crosses another one.
  const Mesh along = joined(cube(0, 10), box({5, 0, 0}, {15, 10, 10}));
  EXPECT_EQ(findSelfIntersections(along).pairs, 0u);
  EXPECT_EQ(arranged(along), Arrangement::Overlapping);
  EXPECT_EQ(arranged(joined(cube(0, 10), inverted(cube(5, 15)))), Arrangement::Overlapping);
}

TEST(Arrangement, LooksAtFacesOfDifferentPartsOnly) {
  // One of two separate parts crosses itself.
  Mesh dented = shapes::sphere(1.0, 2);
  dented.vertices[0] = dented.vertices[0] * -1.5f;
  const Mesh two = joined(dented, shapes::sphere(1.0, 2, {5, 0, 0}));
  EXPECT_GT(findSelfIntersections(two).pairs, 0u);
  EXPECT_EQ(arranged(two), Arrangement::Separate);
  EXPECT_EQ(arranged(joined(two, shapes::sphere(0.5, 2, {5, 0, 0}))), Arrangement::Misnested);
}

TEST(Arrangement, IsOfClosedPartsThatAgree) {
  Mesh open = joined(cube(0, 10), cube(2, 8));
  Mesh turned = open, repeated = open;
  open.triangles.pop_back();
  std::swap(turned.triangles[0].x, turned.triangles[0].y);
  repeated.triangles.push_back({0, 0, 1});
  for (const Mesh& mesh : {open, turned, repeated}) EXPECT_EQ(arranged(mesh), Arrangement::Unknown);
}

TEST(Arrangement, StopsWhenAsked) {
  const MachineOptions stop{.progress = [](std::string_view, double) { return false; }};
  EXPECT_THROW(arranged(cube(0, 10), stop), Error);
}

TEST(Arrangement, IsRightIfWindingNumbersAreZeroOrOne) {
  for (const Arrangement right : {Arrangement::Separate, Arrangement::Nested}) EXPECT_TRUE(isRight(right));
  for (const Arrangement wrong :
       {Arrangement::Unknown, Arrangement::Misnested, Arrangement::Touching, Arrangement::Overlapping})
    EXPECT_FALSE(isRight(wrong));
}

}  // namespace
}  // namespace raymap
