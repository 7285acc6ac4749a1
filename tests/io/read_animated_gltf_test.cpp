#include <gtest/gtest.h>
#include <raymap/animation.h>
#include <raymap/io.h>

#include <limits>

#include "error_code.h"
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

TEST(ReadAnimatedGltf, IgnoresChannelsOfMorphsThatAreNotThere) {
  const std::string text = replaced(json(), kTarget, R"("target":{"node":2,"path":"weights"})");
  EXPECT_TRUE(contains(read(text).warnings, "1 channel of extensions, or of morphs that the node lacks"));
}

/// Returns the square with two morph targets, one of them sparse, whose weights have keys at 0 and 2 seconds.
std::string morphJson(const std::string& interpolation) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"weights":[0.5,0.25],"primitives":[{"attributes":{"POSITION":0},"indices":1,)"
         R"("targets":[{"POSITION":2},{"POSITION":3}]}]}],)"
         R"("animations":[{"name":"Rest","channels":[],"samplers":[]},{"name":"Swell","channels":[)"
         R"({"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":4,"output":5,)"
         R"("interpolation":")" +
         interpolation +
         R"("}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"bufferView":0,"byteOffset":48,"componentType":5123,"count":6,"type":"SCALAR"},)"
         R"({"bufferView":0,"byteOffset":60,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
         R"("indices":{"bufferView":0,"byteOffset":108,"componentType":5123},)"
         R"("values":{"bufferView":0,"byteOffset":112}}},)"
         R"({"bufferView":0,"byteOffset":124,"componentType":5126,"count":2,"type":"SCALAR"},)"
         R"({"bufferView":0,"byteOffset":132,"componentType":5126,"count":)" +
         (interpolation == "CUBICSPLINE" ? "12" : "4") +
         R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":180}],"buffers":[{"byteLength":180}]})";
}

std::string morphBuffer(const std::string& weights) {
  std::string bytes = samples::gltfBuffer() + raw<float>({0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4}) +
                      raw<uint16_t>({2, 0}) + raw<float>({0, 8, 0}) + raw<float>({0, 2}) + weights;
  bytes.resize(180, '\0');
  return bytes;
}

TEST(ReadAnimatedGltf, MorphsByTheWeightsOfTheMesh) {
  const AnimatedMesh mesh = read(morphJson("LINEAR"), morphBuffer("")).mesh;  // The clip without a channel.
  ASSERT_EQ(mesh.morphs.size(), 2u);
  const Mesh moved = posed(mesh, 0.0);
  expectNear(moved.position(1), {1, 0, 1});
  expectNear(moved.position(2), {1, 3, 1.5});
  const std::string text = replaced(morphJson("LINEAR"), R"({"mesh":0})", R"({"mesh":0,"weights":[1,0]})");
  expectNear(posed(read(text, morphBuffer("")).mesh, 0.0).position(2), {1, 1, 3});
}

TEST(ReadAnimatedGltf, MorphsByKeys) {
  const std::string weights = raw<float>({0, 1, 1, 3});  // Of both targets at 0 s, then at 2 s.
  const Mesh moved = posed(read(morphJson("LINEAR"), morphBuffer(weights), 1).mesh, 0.5);
  expectNear(moved.position(0), {0, 0, 0.25});
  expectNear(moved.position(2), {1, 1 + 8 * 1.5, 0.75});
  const Mesh stepped = posed(read(morphJson("STEP"), morphBuffer(weights), 1).mesh, 1.5);
  expectNear(stepped.position(2), {1, 9, 0});
}

TEST(ReadAnimatedGltf, MorphsBySplines) {
  // Each time has a row for the tangents before it, one for the values, one for the tangents after it.
  const std::string weights = raw<float>({9, 9, 0, 1, 1, 0, 0, 2, 4, 3, 9, 9});
  const Mesh moved = posed(read(morphJson("CUBICSPLINE"), morphBuffer(weights), 1).mesh, 0.5);
  const double t = 0.25, t2 = t * t, t3 = t2 * t;  // glTF 2.0, appendix C, with keys 2 s apart.
  const auto spline = [&](double from, double out, double in, double to) {
    return (2 * t3 - 3 * t2 + 1) * from + 2 * (t3 - 2 * t2 + t) * out + (3 * t2 - 2 * t3) * to +
           2 * (t3 - t2) * in;
  };
  expectNear(moved.position(2), {1, 1 + 8 * spline(1, 0, 2, 3), 3 * spline(0, 1, 0, 4)});
}

TEST(ReadAnimatedGltf, NamesWhatIsWrongWithMorphs) {
  const std::string text = morphJson("LINEAR"), bytes = morphBuffer(raw<float>({0, 1, 1, 3}));
  const auto with = [&](const std::string& from, const std::string& to) {
    return errorOf(replaced(text, from, to), bytes, 1);
  };
  EXPECT_EQ(errorOf(text, bytes, 1), "");
  EXPECT_TRUE(contains(with(R"("weights":[0.5,0.25])", R"("weights":[0.5])"),
                       "meshes[0]: 'weights' is not a list of 2"));
  EXPECT_TRUE(contains(with(R"({"mesh":0})", R"({"mesh":0,"weights":[1]})"),
                       "nodes[0]: 'weights' is not a list of 2"));
  EXPECT_TRUE(
      contains(with(R"("targets":[)", R"("targets":7,"others":[)"), "'targets' of a primitive are not"));
  EXPECT_TRUE(contains(with(R"({"POSITION":2})", "7"), "a morph target is not an object"));
  EXPECT_TRUE(contains(with(R"({"POSITION":2})", R"({"POSITION":9})"), "accessors[9] does not exist"));
  EXPECT_TRUE(contains(with(R"({"POSITION":2})", R"({"POSITION":1})"),
                       "accessors[1] holds the offsets of 6 vertices of a morph target, POSITION has 4"));
  EXPECT_TRUE(contains(with(R"("count":4,"type":"SCALAR")", R"("count":3,"type":"SCALAR")"),
                       "has 3 values for 2 times"));
  const std::string nan = raw(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(contains(errorOf(text, std::string(bytes).replace(60 + 12, 4, nan), 1),
                       "accessors[2]: the offset of vertex 1 of a morph target is not finite: nan, 0, 2"));
  EXPECT_TRUE(contains(errorOf(text, std::string(bytes).replace(132, 4, nan), 1), "value 0 holds nan"));
  EXPECT_TRUE(contains(errorOf(replaced(text, R"("targets":[{"POSITION":2},{"POSITION":3}]}])",
                                        R"("targets":[{"POSITION":2},{"POSITION":3}]},)"
                                        R"({"attributes":{"POSITION":0},"targets":[{"POSITION":2}]}])"),
                               bytes, 1),
                       "a mesh has primitives with 2 and with 1 morph target"));
}

TEST(ReadAnimatedGltf, ChoosesAClip) {
  const std::string bytes = morphBuffer(raw<float>({0, 1, 1, 3}));
  std::string warnings;
  const auto choose = [&](const std::string& text, const std::string& clip) -> std::string {
    const std::string file = samples::glb(text, bytes);
    warnings.clear();
    try {
      return std::to_string(readAnimatedGltf({std::as_bytes(std::span(file)), "sample.glb",
                                              [&](const Warning& w) { warnings += w.message; }},
                                             clip)
                                .seconds());
    } catch (const Error& error) {
      return error.what();
    }
  };
  const std::string text = morphJson("LINEAR");
  EXPECT_EQ(choose(text, "Swell"), "2.000000");
  EXPECT_EQ(choose(text, "1"), "2.000000");
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(choose(replaced(text, "Rest", "1"), "Swell"), "2.000000");
  EXPECT_TRUE(contains(choose(replaced(text, "Rest", "1"), "1"), "animations[0] moves nothing"));
  EXPECT_TRUE(contains(choose(text, "Rest"), "animations[0] moves nothing that the scene shows"));
  EXPECT_TRUE(contains(choose(text, "swim"), "there is no animation 'swim'; it has 0 'Rest', 1 'Swell'"));
  EXPECT_TRUE(contains(choose(text, "2"), "there is no animation '2'"));
  choose(text, "");
  EXPECT_TRUE(contains(warnings, "it has the animations 0 'Rest', 1 'Swell'; the first is taken"));
  EXPECT_TRUE(contains(choose(replaced(text, R"("animations")", R"("others")"), ""), "it has no animation"));
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
  EXPECT_TRUE(contains(errorWith("[1,0,0]", "[1,0]"), "nodes[2]: 'translation' is not a list of 3 numbers"));
  EXPECT_TRUE(contains(errorWith("[1,0,0]", R"([1,"up",0])"),
                       R"(nodes[2]: 'translation' holds "up", which is no number)"));
  EXPECT_TRUE(contains(errorWith("[1,0,0]", "[1,NaN,0]"), "no valid JSON"));
  EXPECT_TRUE(contains(errorWith(R"("channels":[)", R"("canals":[)"), "has no list of channels"));
}

TEST(ReadAnimatedGltf, RefusesBadNumbers) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto errorAt = [&](size_t byte, float value) {
    return errorOf(json(), buffer().replace(byte, 4, raw(value)));
  };
  EXPECT_TRUE(contains(errorAt(0, nan), "not finite"));
  EXPECT_TRUE(contains(errorAt(92, nan),
                       "skins[0]: the inverse bind matrix of joint 0 is not finite: its number 0 is nan"));
  EXPECT_TRUE(contains(errorAt(92 + 64 + 52, nan), "matrix of joint 1 is not finite: its number 13 is nan"));
  EXPECT_TRUE(contains(errorAt(220, nan), "time 0 is nan"));
  EXPECT_TRUE(contains(errorAt(220, 2.0F), "time 1 is 1; times must be finite and ascend"));
  EXPECT_TRUE(
      contains(errorAt(228, nan), "animations[0].samplers[0]: value 0 holds nan; values must be finite"));
  EXPECT_TRUE(contains(errorAt(228 + 28, -inf), "value 1 holds -inf"));
  EXPECT_EQ(errorAt(220, 1.0F), "");  // Two keys at one time: it jumps.
  EXPECT_TRUE(contains(errorWith("[1,0,0]", "[1e300,0,0]"), "beyond single precision"));
}

/// Returns the error for weights of single precision.
std::string errorWithWeight(float weight) {
  std::string text = replaced(json(), R"("byteOffset":76,"componentType":5121,"normalized":true)",
                              R"("byteOffset":260,"componentType":5126)");
  text = replaced(text, R"("byteLength":260}],"buffers":[{"byteLength":260})",
                  R"("byteLength":324}],"buffers":[{"byteLength":324})");
  return errorOf(text, buffer() + raw<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, weight, 0, 0, 1, 0, 0, 0}));
}

TEST(ReadAnimatedGltf, RefusesWeightsThatAreNone) {
  EXPECT_EQ(errorWithWeight(0.0F), "");
  EXPECT_TRUE(contains(errorWithWeight(std::numeric_limits<float>::quiet_NaN()),
                       "vertex 2 of a skin has the weight nan; weights must be finite and not negative"));
  EXPECT_TRUE(contains(errorWithWeight(std::numeric_limits<float>::infinity()), "has the weight inf"));
  EXPECT_TRUE(contains(errorWithWeight(-0.5F), "has the weight -0.5"));
}

TEST(ReadAnimatedGltf, RefusesAMatrixThatFlattensTheMesh) {
  const auto errorWithMatrix = [](std::initializer_list<float> columns) {
    return errorOf(json(), buffer().replace(92 + 64, 4 * columns.size(), raw<float>(columns)));
  };
  const std::string text =
      "vertex 1 of a skin follows joint 1, whose inverse bind matrix is singular: it would flatten the mesh";
  EXPECT_TRUE(contains(errorWithMatrix({0, 0, 0}), text));
  EXPECT_TRUE(contains(errorWithMatrix({1, 2, 3, 0, 4, 5, 6, 0, 5, 7, 9, 0}), text));
  EXPECT_TRUE(contains(errorWithMatrix({0.1F, 0.2F, 0.7F, 0, 0.3F, 0.6F, 2.1F, 0, 0, 1, 0, 0}), text));
  EXPECT_EQ(errorWithMatrix({1e-4F, 0, 0, 0, 0, 1e-4F, 0, 0, 0, 0, 1e-4F, 0}), "");  // Small is not flat.
  EXPECT_EQ(errorWithMatrix({1, 0.999F, 0, 0}), "");
  // The first joint moves no vertex: its matrix does not count.
  const std::string all("\1\0\0\0", 4);
  const std::string bytes = buffer().replace(60, 16, all + all + all + all).replace(92, 4, raw(0.0F));
  EXPECT_EQ(errorOf(json(), bytes), "");
}

TEST(ReadAnimatedGltf, SaysThatASkinIsMissing) {
  const std::string warning =
      "4 vertices with a skin but no JOINTS_0, or with JOINTS_0 but no skin: their node alone moves them";
  EXPECT_TRUE(contains(read(replaced(json(), R"({"mesh":0,"skin":0})", R"({"mesh":0})")).warnings, warning));
  EXPECT_TRUE(
      contains(read(replaced(json(), kAttributes, R"("attributes":{"POSITION":0})")).warnings, warning));
  EXPECT_TRUE(contains(errorWith(kSkin, ""), "skins[0] does not exist: the file has 0"));
}

TEST(ReadAnimatedGltf, RefusesATrackWithoutKeys) {
  const std::string text = replaced(json(), R"("byteOffset":220,"componentType":5126,"count":2)",
                                    R"("byteOffset":220,"componentType":5126,"count":0)");
  EXPECT_TRUE(contains(errorOf(text), "animations[0].samplers[0] has no times"));
}

TEST(ReadAnimatedGltf, RefusesOtherFormats) {
  EXPECT_EQ(codeOf([&] { readAnimatedMesh("mesh.obj"); }), ErrorCode::Unsupported);
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
