#include "view/rigid_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raymap::view {
namespace {

using Track = AnimatedMesh::Track;

const double kHalf = std::sqrt(0.5);

/// Returns a tetrahedron on two joints, of which the second hangs on the first. The first turns a quarter
/// around z within a second, and moves.
AnimatedMesh turning() {
  AnimatedMesh mesh;
  mesh.rest = {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}},
               .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}},
               .origin = {10, 0, 0}};
  mesh.joints = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 2, 0, 0}};
  mesh.weights = {{1, 0, 0, 0}, {1, 0, 0, 0}, {0.5, 0.5, 0, 0}, {1, 0, 0, 0}};
  mesh.nodes = {{}, {.parent = 0, .translation = {0, 0, 1}, .scale = {2, 2, 2}}, {}};
  mesh.skeleton = {{.node = 0}, {.node = 1}, {.node = 2}};
  mesh.tracks = {{.node = 0,
                  .target = Track::Target::Rotation,
                  .times = {0.0, 1.0, 2.0},
                  .values = {{0, 0, 0, 1}, {0, 0, kHalf, kHalf}, {0, 0, kHalf, kHalf}}},
                 {.node = 0, .times = {0.0, 1.0}, .values = {{0, 0, 0, 0}, {0, 0, 5, 0}}}};
  mesh.origin = {7, -3, 2};
  return mesh;
}

/// Expects that the motion takes each vertex of one pose to that of the other.
void expectMoves(const AnimatedMesh& mesh, double from, double to) {
  const std::optional<RigidMotion> motion = RigidPoses(mesh).between(from, to);
  ASSERT_TRUE(motion);
  const Mesh before = posed(mesh, from), after = posed(mesh, to);
  for (uint32_t v = 0; v < 4; ++v)
    EXPECT_LT(glm::distance(motion->rotation * before.position(v) + motion->translation, after.position(v)),
              2e-5);
}

TEST(RigidPoses, FindsTheMotionBetweenTwoPoses) {
  const AnimatedMesh mesh = turning();
  expectMoves(mesh, 0.0, 1.0);
  expectMoves(mesh, 0.8, 0.3);
  const RigidMotion quarter = *RigidPoses(mesh).between(0.0, 1.0);
  EXPECT_LT(glm::distance(quarter.rotation * glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)), 1e-6);
  EXPECT_LT(glm::length(quarter.translation - glm::dvec3(0, 0, 5)), 1e-5);
}

TEST(RigidPoses, DoNotMoveWhereNothingDoes) {
  const AnimatedMesh mesh = turning();
  EXPECT_EQ(RigidPoses(mesh).between(0.25, 0.25), RigidMotion());
  EXPECT_EQ(RigidPoses(mesh).between(1.0, 1.5), RigidMotion());
  EXPECT_EQ(RigidPoses(mesh).between(1.0, 99.0), RigidMotion());
  EXPECT_NE(RigidPoses(mesh).between(0.5, 1.0), RigidMotion());
}

TEST(RigidPoses, RefuseWhatBends) {
  const auto isRigid = [](const auto& change) {
    AnimatedMesh mesh = turning();
    change(mesh);
    return RigidPoses(mesh).between(0.0, 1.0).has_value();
  };
  EXPECT_TRUE(isRigid([](AnimatedMesh&) {}));
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) { m.tracks[0].node = 1; }));
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) { m.tracks[1].node = 1; }));
  // A joint counts as soon as a vertex follows it, the third one from here on.
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) { m.weights[3] = {0.99, 0.01, 0, 0}; }));
  // Neither do mirrors and scales move it rigidly.
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) {
    m.tracks[1] = {
        .node = 0, .target = Track::Target::Scale, .times = {0, 1}, .values = {{1, 1, 1, 0}, {1, 1, -1, 0}}};
  }));
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) {
    m.tracks[1] = {.node = 0,
                   .target = Track::Target::Scale,
                   .times = {0, 1},
                   .values = {{1, 1, 1, 0}, {1, 1, 1.001, 0}}};
  }));
  // A pose that is flat, or no joint at all.
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) {
    m.tracks[1] = {
        .node = 0, .target = Track::Target::Scale, .times = {0, 1}, .values = {{1, 1, 0, 0}, {1, 1, 1, 0}}};
  }));
  EXPECT_FALSE(isRigid([](AnimatedMesh& m) { m.weights.assign(4, glm::vec4(0.0F)); }));
}

TEST(RigidPoses, SeeMorphs) {
  AnimatedMesh mesh = turning();
  mesh.morphs = {{.weight = 0.5, .offsets = {{0, 0, 1}}}};
  expectMoves(mesh, 0.0, 1.0);
  mesh.tracks.push_back({.node = 0,
                         .target = Track::Target::Weight,
                         .times = {0.0, 1.0},
                         .values = {{0, 0, 0, 0}, {1, 0, 0, 0}}});
  EXPECT_FALSE(RigidPoses(mesh).between(0.0, 1.0));
  EXPECT_EQ(RigidPoses(mesh).between(1.0, 2.0), RigidMotion());
}

TEST(RigidPoses, MoveFarAway) {
  AnimatedMesh mesh = turning();
  mesh.tracks[1].values[1] = {1e4, 0, 0, 0};
  const RigidMotion motion = *RigidPoses(mesh).between(0.0, 1.0);
  EXPECT_NEAR(motion.translation.x, 1e4, 0.01);
}

}  // namespace
}  // namespace raymap::view
