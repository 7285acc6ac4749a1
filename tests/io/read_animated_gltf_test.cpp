#include <gtest/gtest.h>
#include <raymap/animation.h>
#include <raymap/io.h>

#include <limits>

#include "mesh_folder.h"
#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::raw;
using samples::replaced;

const std::string kAttributes = R"("attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3})";
const std::string kSkin = R"("skins":[{"joints":[1,2],"inverseBindMatrices":4}],)";
const std::string kTarget = R"("target":{"node":2,"path":"rotation"})";
const std::string kAnimations =
    R"("animations":[{"channels":[{"sampler":0,)" + kTarget + R"(}],"samplers":[{"input":5,"output":6}]}],)";

/// Returns the JSON of an animation: the square's right side turns a quarter around z, about its lower end,
/// in one second.
std::string json() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},)"
         R"({"children":[2]},{"translation":[1,0,0]}],"meshes":[{"primitives":[{)" +
         kAttributes + R"(,"indices":1}]}],)" + kSkin + kAnimations +
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"bufferView":0,"byteOffset":48,"componentType":5123,"count":6,"type":"SCALAR"},)"
         R"({"bufferView":0,"byteOffset":60,"componentType":5121,"count":4,"type":"VEC4"},)"
         R"({"bufferView":0,"byteOffset":76,"componentType":5121,"normalized":true,"count":4,"type":"VEC4"},)"
         R"({"bufferView":0,"byteOffset":92,"componentType":5126,"count":2,"type":"MAT4"},)"
         R"({"bufferView":0,"byteOffset":220,"componentType":5126,"count":2,"type":"SCALAR"},)"
         R"({"bufferView":0,"byteOffset":228,"componentType":5126,"count":2,"type":"VEC4"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":260}],"buffers":[{"byteLength":260}]})";
}

std::string buffer(const std::string& weights = std::string("\377\0\0\0", 4)) {
  const std::string first(4, '\0'), second("\1\0\0\0", 4);
  const float h = 0.70710678F;
  return samples::gltfBuffer() + first + second + second + first + weights + weights + weights + weights +
         raw<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}) +
         raw<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}) + raw<float>({0, 1}) +
         raw<float>({0, 0, 0, 1, 0, 0, h, h});
}

struct Reading {
  AnimatedMesh mesh;
  std::string warnings;
};

Reading read(const std::string& text, const std::string& bytes = buffer(), size_t animation = 0) {
  const std::string file = samples::glb(text, bytes);
  Reading result;
  result.mesh = readAnimatedGltf({std::as_bytes(std::span(file)), "sample.glb",
                                  [&](const Warning& w) { result.warnings.append(w.message) += '\n'; }},
                                 animation);
  return result;
}

std::string errorOf(const std::string& text, const std::string& bytes = buffer(), size_t animation = 0) {
  try {
    read(text, bytes, animation);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string errorWith(const std::string& from, const std::string& to) {
  return errorOf(replaced(json(), from, to));
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LE(glm::distance(a, b), 1e-6) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(ReadAnimatedGltf, MovesASkin) {
  const Reading reading = read(json());
  EXPECT_EQ(reading.warnings, "");
  EXPECT_EQ(reading.mesh.seconds(), 1.0);
  EXPECT_TRUE(samples::isSquare(posed(reading.mesh, 0.0)));
  const Mesh half = posed(reading.mesh, 0.5), end = posed(reading.mesh, 1.0);
  const double h = std::sqrt(0.5);
  expectNear(half.position(2), {1 - h, h, 0});
  expectNear(end.position(1), {1, 0, 0});
  expectNear(end.position(2), {0, 0, 0});
  expectNear(end.position(3), {0, 1, 0});
}

TEST(ReadAnimatedGltf, MovesNodesWithoutSkin) {
  std::string text = replaced(json(), R"({"mesh":0,"skin":0})", R"({"mesh":0})");
  text = replaced(text, R"("node":2)", R"("node":0)");
  const Reading reading = read(text);
  EXPECT_EQ(reading.mesh.skeleton.size(), 1u);
  expectNear(posed(reading.mesh, 1.0).position(2), {-1, 1, 0});
}

TEST(ReadAnimatedGltf, StandsStillWithoutAnimation) {
  const Reading reading = read(replaced(json(), kAnimations, ""));
  EXPECT_TRUE(contains(reading.warnings, "no animation"));
  EXPECT_EQ(reading.mesh.seconds(), 0.0);
  EXPECT_TRUE(samples::isSquare(posed(reading.mesh, 5.0)));
}

TEST(ReadAnimatedGltf, TurnsMirroredSurfacesOutwards) {
  const std::string text = replaced(json(), R"({"children":[2]})", R"({"children":[2],"scale":[-1,1,1]})");
  EXPECT_EQ(samples::areaVector(posed(read(text).mesh, 0.0)), glm::dvec3(0, 0, 1));
}

TEST(ReadAnimatedGltf, LeavesMorphsAtRest) {
  const std::string text = replaced(json(), kTarget, R"("target":{"node":2,"path":"weights"})");
  EXPECT_TRUE(contains(read(text).warnings, "1 channel of morphs"));
}

TEST(ReadAnimatedGltf, KeepsTheFourWeightsThatCountMost) {
  // The second set repeats the first: eight joints per vertex, in equal pairs.
  const std::string attributes =
      R"("attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3,"JOINTS_1":2,"WEIGHTS_1":3})";
  const Reading reading =
      read(replaced(json(), kAttributes, attributes), buffer(std::string("\100\200\20\40", 4)));
  EXPECT_TRUE(contains(reading.warnings, "4 vertices with more than four joints"));
  const float sum = 2 * (128 + 64);
  EXPECT_EQ(reading.mesh.weights[0], glm::vec4(128 / sum, 128 / sum, 64 / sum, 64 / sum));
}

TEST(ReadAnimatedGltf, LetsTheFirstJointMoveWhatHasNoWeight) {
  const Reading reading = read(json(), buffer(std::string(4, '\0')));
  EXPECT_TRUE(contains(reading.warnings, "4 vertices without weights"));
  EXPECT_EQ(reading.mesh.weights[1], glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(reading.mesh.joints[1], glm::u16vec4(0));
}

TEST(ReadAnimatedGltf, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(json()), "");
  EXPECT_TRUE(contains(errorOf(json(), buffer(), 3), "there is no animation 3: it has 1 animation"));
  EXPECT_TRUE(contains(errorWith(R"("joints":[1,2])", R"("joints":[1])"), "follows joint 1 of 1"));
  EXPECT_TRUE(contains(errorWith(R"("joints":[1,2])", R"("joints":[])"), "skins[0] has no joints"));
  EXPECT_TRUE(contains(errorWith(R"("joints":[1,2])", R"("joints":[1,9])"),
                       "skins[0]: joint 1 is node 9, which is not in the scene"));
  EXPECT_TRUE(contains(errorWith(R"("joints":[1,2])", R"("joints":[1,2,1])"),
                       "skins[0] has 3 joints, but 2 inverse bind matrices"));
  EXPECT_TRUE(contains(errorWith(R"("skin":0)", R"("skin":1)"), "skins[1] does not exist"));
  EXPECT_TRUE(contains(errorWith(R"("JOINTS_0":2)", R"("JOINTS_0":0)"), "should have type VEC4"));
  EXPECT_TRUE(
      contains(errorWith(R"("JOINTS_0":2)", R"("JOINTS_0":6)"), "JOINTS_0 of 2 vertices, POSITION has 4"));
  EXPECT_TRUE(
      contains(errorWith(R"("WEIGHTS_0":3)", R"("WEIGHTS_0":3,"JOINTS_1":6)"), "JOINTS_1 of 2 vertices"));
  EXPECT_TRUE(contains(errorWith("5121,\"count\":4,\"type\":\"VEC4\"", "5126,\"count\":4,\"type\":\"VEC4\""),
                       "accessors[2] holds joints of componentType 5126"));
  EXPECT_TRUE(contains(errorWith(R"(,"WEIGHTS_0":3)", ""), "'WEIGHTS_0' is missing"));
  EXPECT_TRUE(
      contains(errorWith(R"("sampler":0)", R"("sampler":1)"), "animations[0].samplers[1] does not exist"));
  EXPECT_TRUE(contains(errorWith(R"("node":2)", R"("node":7)"), "nodes[7] does not exist"));
  EXPECT_TRUE(contains(errorWith(R"("input":5)", R"("input":6)"), "should have type SCALAR"));
  EXPECT_TRUE(contains(errorWith(R"("output":6)", R"("output":6,"interpolation":"CUBICSPLINE")"),
                       "animations[0].samplers[0] has 2 values for 2 times"));
  EXPECT_TRUE(contains(errorWith(R"("output":6)", R"("output":6,"interpolation":"WILD")"),
                       "unknown interpolation WILD"));
  EXPECT_TRUE(contains(errorWith(kTarget, R"("target":3)"), "animations[0]: a channel has no target"));
  EXPECT_TRUE(contains(errorWith(R"("channels":[)", R"("canals":[)"), "has no list of channels"));
}

TEST(ReadAnimatedGltf, RefusesBadNumbers) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto errorAt = [&](size_t byte, float value) {
    return errorOf(json(), buffer().replace(byte, 4, raw(value)));
  };
  EXPECT_TRUE(contains(errorAt(0, nan), "not finite"));
  EXPECT_TRUE(contains(errorAt(92, nan), "the inverse bind matrix of joint 0 is not finite"));
  EXPECT_TRUE(contains(errorAt(220, nan), "time 0 is nan"));
  EXPECT_TRUE(contains(errorAt(220, 2.0F), "time 1 is 1; times must be finite and ascend"));
  EXPECT_TRUE(contains(errorAt(228, nan), "value 0 is not finite"));
  EXPECT_TRUE(contains(errorWith("[1,0,0]", "[1e300,0,0]"), "beyond single precision"));
}

TEST(ReadAnimatedGltf, RefusesOtherFormats) {
  try {
    readAnimatedMesh("mesh.obj");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

TEST(ReadAnimatedGltf, RealMeshes) {
  const std::filesystem::path path = meshFolder() / "draco__CesiumMan.glb";
  RAYMAP_NEED_MESHES();
  const AnimatedMesh mesh = readAnimatedMesh(path);
  EXPECT_EQ(mesh.skeleton.size(), 19u);
  EXPECT_NEAR(mesh.seconds(), 2.0, 0.05);
  // A walking man, 1.5 units tall, neither falls apart nor leaves his place.
  for (const double seconds : {0.0, 0.5, 1.0, 1.5}) {
    const glm::dvec3 size = bounds(posed(mesh, seconds)).size();
    EXPECT_NEAR(std::max({size.x, size.y, size.z}), 1.5, 0.15);
    EXPECT_LT(glm::length(bounds(posed(mesh, seconds)).centre()), 1.0);
  }
}

}  // namespace
}  // namespace raymap
