#include <gtest/gtest.h>
#include <raymap/animation.h>
#include <raymap/error.h>

#include <numbers>

#include "contains.h"

namespace raymap {
namespace {

using Track = AnimatedMesh::Track;

const double kHalf = std::sqrt(0.5);

/// Returns a triangle whose corners follow the first node, the second, and both equally.
AnimatedMesh triangle() {
  AnimatedMesh mesh;
  mesh.rest = {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  mesh.joints = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}};
  mesh.weights = {{1, 0, 0, 0}, {1, 0, 0, 0}, {0.5, 0.5, 0, 0}};
  mesh.nodes = {{}, {.parent = 0}};
  mesh.skeleton = {{.node = 0}, {.node = 1}};
  return mesh;
}

glm::dvec3 corner(const AnimatedMesh& mesh, uint32_t vertex, double seconds) {
  return posed(mesh, seconds).position(vertex);
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LE(glm::distance(a, b), 1e-6) << a.x << ' ' << a.y << ' ' << a.z;
}

std::string errorOf(const AnimatedMesh& mesh) {
  try {
    validate(mesh);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(AnimatedMesh, BlendsWhereJointsTakeAVertex) {
  AnimatedMesh mesh = triangle();
  mesh.tracks = {{.node = 1, .times = {1.0, 3.0}, .values = {{0, 0, 0, 0}, {0, 0, 8, 0}}}};
  EXPECT_EQ(mesh.seconds(), 3.0);
  expectNear(corner(mesh, 0, 2.0), {0, 0, 0});
  expectNear(corner(mesh, 1, 2.0), {1, 0, 4});
  expectNear(corner(mesh, 2, 2.0), {0, 1, 2});
  expectNear(corner(mesh, 1, 0.0), {1, 0, 0});
  expectNear(corner(mesh, 1, 9.0), {1, 0, 8});
  expectNear(corner(mesh, 1, NAN), {1, 0, 0});
}

TEST(AnimatedMesh, MorphsBeforeJointsMove) {
  AnimatedMesh mesh = triangle();
  mesh.rest.origin = {100, 0, 0};
  mesh.nodes[0].scale = {2, 2, 2};
  mesh.morphs = {{.weight = 0.5, .firstVertex = 1, .offsets = {{0, 0, 2}, {0, 0, 4}}},
                 {.firstVertex = 0, .offsets = {{1, 0, 0}}}};
  mesh.tracks = {{.node = 1,
                  .target = Track::Target::Weight,
                  .times = {0.0, 1.0},
                  .values = {{0, 0, 0, 0}, {8, 0, 0, 0}}}};
  EXPECT_EQ(morphWeights(mesh, 0.25), (std::vector<double>{0.5, 2.0}));
  expectNear(corner(mesh, 0, 0.25), {204, 0, 0});
  expectNear(corner(mesh, 1, 0.25), {202, 0, 2});
  expectNear(corner(mesh, 2, 0.25), {200, 2, 4});
}

TEST(AnimatedMesh, NamesABadMorph) {
  AnimatedMesh mesh = triangle();
  mesh.morphs = {{.firstVertex = 1, .offsets = {{0, 0, 2}, {0, 0, 4}}}};
  EXPECT_EQ(errorOf(mesh), "");
  mesh.tracks = {{.node = 1, .target = Track::Target::Weight, .times = {0.0}, .values = {{1, 0, 0, 0}}}};
  EXPECT_TRUE(contains(errorOf(mesh), "track 0 moves morph 1"));
  mesh.tracks[0].node = 0;
  EXPECT_EQ(errorOf(mesh), "");
  mesh.morphs[0].firstVertex = 2;
  EXPECT_TRUE(contains(errorOf(mesh), "morph 0 moves vertex 3 of 3"));
}

TEST(AnimatedMesh, HangsNodesOnTheirParents) {
  AnimatedMesh mesh = triangle();
  mesh.nodes[0].rotation = {kHalf, 0, 0, kHalf};  // x to y
  mesh.nodes[0].translation = {10, 0, 0};
  mesh.nodes[1].scale = {2, 1, 1};
  mesh.nodes[1].matrix[3] = {0.5, 0, 0, 1};
  expectNear(corner(mesh, 0, 0.0), {10, 0, 0});
  expectNear(corner(mesh, 1, 0.0), {10, 3, 0});
  mesh.skeleton[1].inverseBind[3] = {-1, 0, 0, 1};
  expectNear(corner(mesh, 1, 0.0), {10, 1, 0});
}

TEST(AnimatedMesh, StepsTurnsAndFollowsSplines) {
  AnimatedMesh mesh = triangle();
  Track track{.node = 1,
              .interpolation = Track::Interpolation::Step,
              .times = {0.0, 2.0},
              .values = {{1, 0, 0, 0}, {5, 0, 0, 0}}};
  mesh.tracks = {track};
  expectNear(corner(mesh, 1, 1.9), {2, 0, 0});

  track = {.node = 1,
           .target = Track::Target::Rotation,
           .times = {0.0, 2.0},
           .values = {{0, 0, 0, 1}, {0, 0, -kHalf, -kHalf}}};  // The same quarter turn, negated.
  mesh.tracks = {track};
  expectNear(corner(mesh, 1, 1.0), {kHalf, kHalf, 0});
  expectNear(corner(mesh, 1, 2.0), {0, 1, 0});

  // x = t^3 - t + 3 between 0 and 2: slopes -1 and 11, values 3 and 9.
  track = {.node = 1,
           .interpolation = Track::Interpolation::CubicSpline,
           .times = {0.0, 2.0},
           .values = {{9, 9, 9, 0}, {3, 0, 0, 0}, {-1, 0, 0, 0}, {11, 0, 0, 0}, {9, 0, 0, 0}, {9, 9, 9, 0}}};
  mesh.tracks = {track};
  for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0}) expectNear(corner(mesh, 1, t), {4 + t * t * t - t, 0, 0});
}

TEST(AnimatedMesh, LosesNothingFarFromTheOrigin) {
  AnimatedMesh mesh = triangle();
  mesh.rest.origin = {1e6, 0, 0};
  mesh.nodes[0].translation = {1e6, 0, 0};
  mesh.origin = {2e6, 0, 0};
  mesh.nodes[1].translation = {0, 0, 1.0 / 3.0};
  for (uint32_t v = 0; v < 2; ++v)
    expectNear(corner(mesh, v, 0.0), mesh.rest.position(v) + glm::dvec3(1e6, 0, v / 3.0));
}

TEST(AnimatedMesh, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(triangle()), "");
  AnimatedMesh mesh = triangle();
  mesh.joints[1][2] = 2;
  EXPECT_TRUE(contains(errorOf(mesh), "vertex 1 follows joint 2 of 2"));
  mesh = triangle();
  mesh.weights.pop_back();
  EXPECT_TRUE(contains(errorOf(mesh), "3 vertices have 3 sets of joints and 2 of weights"));
  mesh = triangle();
  mesh.nodes[1].parent = 1;
  EXPECT_TRUE(contains(errorOf(mesh), "node 1 hangs on node 1"));
  mesh = triangle();
  mesh.skeleton[1].node = 7;
  EXPECT_TRUE(contains(errorOf(mesh), "joint 1 is node 7 of 2"));
  const Track good{.node = 0, .times = {0.0, 1.0}, .values = {{0, 0, 0, 0}, {0, 0, 0, 0}}};
  const auto errorWith = [&](const auto& change) {
    AnimatedMesh moving = triangle();
    moving.tracks = {good, good};
    change(moving.tracks[1]);
    return errorOf(moving);
  };
  EXPECT_EQ(errorWith([](Track&) {}), "");
  EXPECT_TRUE(contains(errorWith([](Track& t) { t.node = 2; }), "track 1 moves node 2"));
  EXPECT_TRUE(contains(errorWith([](Track& t) { t.times.clear(); }), "track 1 has no times"));
  EXPECT_TRUE(contains(errorWith([](Track& t) { t.times[1] = -1; }),
                       "track 1 goes back in time: time 1 is -1, after 0"));
  EXPECT_TRUE(contains(errorWith([](Track& t) { t.values.pop_back(); }), "track 1 has 1 values for 2 times"));
}

TEST(AnimatedMesh, NamesNumbersThatAreNotFinite) {
  const auto errorWith = [](const auto& change) {
    AnimatedMesh mesh = triangle();
    mesh.tracks = {{.node = 1, .times = {0.0, 1.0}, .values = {{0, 0, 0, 0}, {0, 0, 0, 0}}}};
    mesh.morphs = {{.firstVertex = 1, .offsets = {{0, 0, 2}, {0, 0, 4}}}};
    change(mesh);
    return errorOf(mesh);
  };
  EXPECT_EQ(errorWith([](AnimatedMesh&) {}), "");
  const auto expect = [&](const std::string& text, const auto& change) {
    EXPECT_TRUE(contains(errorWith(change), text + ", which is not finite")) << errorWith(change);
  };
  expect("a weight of vertex 2 holds nan", [](AnimatedMesh& m) { m.weights[2][3] = NAN; });
  expect("the translation of node 1 holds inf", [](AnimatedMesh& m) { m.nodes[1].translation.z = INFINITY; });
  expect("the rotation of node 0 holds nan", [](AnimatedMesh& m) { m.nodes[0].rotation.w = NAN; });
  expect("the scale of node 1 holds -inf", [](AnimatedMesh& m) { m.nodes[1].scale.x = -INFINITY; });
  expect("the matrix of node 1 holds nan", [](AnimatedMesh& m) { m.nodes[1].matrix[3][3] = NAN; });
  expect("the inverse bind matrix of joint 1 holds nan",
         [](AnimatedMesh& m) { m.skeleton[1].inverseBind[0][0] = NAN; });
  expect("time 1 of track 0 is inf", [](AnimatedMesh& m) { m.tracks[0].times[1] = INFINITY; });
  expect("time 0 of track 0 is nan", [](AnimatedMesh& m) { m.tracks[0].times[0] = NAN; });
  expect("value 1 of track 0 holds nan", [](AnimatedMesh& m) { m.tracks[0].values[1].w = NAN; });
  expect("the offset of vertex 2 by morph 0 holds nan",
         [](AnimatedMesh& m) { m.morphs[0].offsets[1].y = NAN; });
  EXPECT_TRUE(
      contains(errorWith([](AnimatedMesh& m) { m.morphs[0].weight = NAN; }), "morph 0 has the weight nan"));
}

}  // namespace
}  // namespace raymap
