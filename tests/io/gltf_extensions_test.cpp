#include <gtest/gtest.h>
#include <raymap/animation.h>
#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include <filesystem>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::errorOf;
using samples::glb;
using samples::gltf;
using samples::raw;
using samples::read;
using samples::replaced;

/// Returns the square with more accessors, each the rest of an object and the bytes of its bufferView.
std::string squareWith(const std::string& nodes,
                       const std::vector<std::pair<std::string, std::string>>& accessors,
                       const std::string& root = "{",
                       const std::string& primitive = R"("attributes":{"POSITION":0},"indices":1)") {
  std::string buffer = samples::gltfBuffer(), list, views;
  for (size_t i = 0; i < accessors.size(); ++i) {
    list += R"(,{"bufferView":)" + std::to_string(i + 2) + "," + accessors[i].first + "}";
    views += R"(,{"buffer":0,"byteOffset":)" + std::to_string(buffer.size()) + R"(,"byteLength":)" +
             std::to_string(accessors[i].second.size()) + "}";
    buffer += accessors[i].second;
  }
  std::string text = gltf(R"("byteLength":)" + std::to_string(buffer.size()), nodes, primitive);
  text = replaced(text, R"(],"bufferViews")", list + R"(],"bufferViews")");
  text = replaced(text, R"(],"buffers")", views + R"(],"buffers")");
  return glb(replaced(text, "{", root), buffer);
}

std::string instanced(const std::string& attributes, const std::string& more = "") {
  return R"({"mesh":0)" + more + R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)" + attributes +
         "}}}}";
}

const std::string kFloats3 = R"("componentType":5126,"type":"VEC3","count":)";
const std::string kFloats4 = R"("componentType":5126,"type":"VEC4","count":)";

TEST(GltfInstances, PlacesEach) {
  const std::string nodes =
      instanced(R"("TRANSLATION":2,"ROTATION":3,"SCALE":4,"_ID":5)", R"(,"translation":[0,0,100])");
  const float h = 0.70710678F;
  const Mesh mesh =
      read(readGltf, squareWith(nodes, {{kFloats3 + "2", raw<float>({10, 0, 0, 20, 0, 0})},
                                        {kFloats4 + "2", raw<float>({0, 0, h, h, 0, 0, 0, 2})},
                                        {kFloats3 + "2", raw<float>({2, 3, 1, -1, 1, 1})},
                                        {R"("componentType":5121,"type":"SCALAR","count":2)", "ab"}}))
          .mesh;
  ASSERT_EQ(mesh.triangles.size(), 4u);
  // The far corner (1, 1): scaled to (2, 3), turned to (-3, 2) and moved; mirrored and moved.
  EXPECT_NEAR(glm::distance(mesh.position(2), glm::dvec3(7, 2, 100)), 0, 1e-6);
  EXPECT_EQ(mesh.position(6), glm::dvec3(19, 1, 100));
  EXPECT_NEAR(glm::distance(samples::areaVector(mesh), glm::dvec3(0, 0, 7)), 0, 1e-5);
}

TEST(GltfInstances, NeedsNoMoreThanOneAttribute) {
  const auto boxOf = [](const std::string& name, const std::string& accessor, const std::string& bytes) {
    return bounds(read(readGltf, squareWith(instanced("\"" + name + "\":2"), {{accessor, bytes}})).mesh);
  };
  EXPECT_EQ(boxOf("TRANSLATION", kFloats3 + "2", raw<float>({0, 0, 0, 0, 0, 7})).max, glm::dvec3(1, 1, 7));
  EXPECT_EQ(boxOf("SCALE", kFloats3 + "1", raw<float>({2, 3, 1})).max, glm::dvec3(2, 3, 0));
  // A half turn about z in bytes, and a quarter turn in 16 bits.
  const Box half = boxOf("ROTATION", R"("componentType":5120,"normalized":true,"type":"VEC4","count":1)",
                         std::string("\0\0\x7f\0", 4));
  EXPECT_EQ(half.min, glm::dvec3(-1, -1, 0));
  EXPECT_EQ(half.max, glm::dvec3(0, 0, 0));
  const Box quarter = boxOf("ROTATION", R"("componentType":5122,"normalized":true,"type":"VEC4","count":1)",
                            raw<int16_t>({0, 0, 23170, 23170}));
  EXPECT_NEAR(quarter.min.x, -1, 1e-6);
  EXPECT_NEAR(quarter.max.y, 1, 1e-6);
  const std::string none =
      squareWith(instanced(R"("_ID":2)"), {{R"("componentType":5121,"type":"SCALAR","count":3)", "abc"}});
  EXPECT_EQ(read(readGltf, none).mesh.triangles.size(), 6u);
  EXPECT_EQ(read(readGltf, squareWith(instanced(""), {})).mesh.triangles.size(), 2u);
}

TEST(GltfInstances, AreRefusedIfTheirCountsDiffer) {
  EXPECT_TRUE(contains(errorOf(readGltf, squareWith(instanced(R"("SCALE":3,"TRANSLATION":2)"),
                                                    {{kFloats3 + "2", raw<float>({0, 0, 0, 1, 0, 0})},
                                                     {kFloats3 + "1", raw<float>({1, 1, 1})}})),
                       "nodes[0]: its instances have 1 and 2 values"));
}

TEST(GltfInstances, MoveWithTheirNode) {
  const std::string nodes = instanced(R"("TRANSLATION":2)");
  const std::string animation =
      R"({"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],)"
      R"("samplers":[{"input":3,"output":4}]}],)";
  const std::string bytes =
      squareWith(nodes,
                 {{kFloats3 + "2", raw<float>({10, 0, 0, 20, 0, 0})},
                  {R"("componentType":5126,"type":"SCALAR","count":2)", raw<float>({0, 1})},
                  {kFloats3 + "2", raw<float>({0, 0, 0, 0, 0, 5})}},
                 animation);
  const AnimatedMesh mesh = readAnimatedGltf({std::as_bytes(std::span(bytes)), "a.glb", {}});
  EXPECT_EQ(mesh.rest.triangles.size(), 4u);
  EXPECT_EQ(mesh.nodes.size(), 3u);
  for (const double time : {0.0, 1.0}) {
    const Box box = bounds(posed(mesh, time));
    EXPECT_NEAR(glm::distance(box.min, glm::dvec3(10, 0, 5 * time)), 0, 1e-5);
    EXPECT_NEAR(glm::distance(box.max, glm::dvec3(21, 1, 5 * time)), 0, 1e-5);
  }
}

TEST(GltfInstances, MorphTogether) {
  const std::string bytes =
      squareWith(instanced(R"("TRANSLATION":2)", R"(,"weights":[1])"),
                 {{kFloats3 + "2", raw<float>({10, 0, 0, 20, 0, 0})},
                  {kFloats3 + "4", raw<float>({0, 0, 3, 0, 0, 3, 0, 0, 3, 0, 0, 3})}},
                 "{", R"("attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":3}])");
  const AnimatedMesh mesh = readAnimatedGltf({std::as_bytes(std::span(bytes)), "a.glb", {}});
  ASSERT_EQ(mesh.morphs.size(), 1u);
  EXPECT_EQ(mesh.morphs[0].offsets.size(), 8u);
  const Box box = bounds(posed(mesh, 0.0));
  EXPECT_NEAR(glm::distance(box.min, glm::dvec3(10, 0, 3)), 0, 1e-5);
  EXPECT_NEAR(glm::distance(box.max, glm::dvec3(21, 1, 3)), 0, 1e-5);
}

TEST(GltfExtensions, RequiredOnesMustBeKnown) {
  const auto error = [](const std::string& name) {
    return errorOf(readGltf, glb(replaced(gltf(R"("byteLength":60)"), "{",
                                          R"({"extensionsRequired":[")" + name + "\"],")));
  };
  for (const char* name :
       {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "KHR_node_visibility",
        "KHR_draco_mesh_compression", "KHR_meshopt_compression", "KHR_materials_unlit", "KHR_texture_basisu",
        "EXT_texture_webp", "MSFT_texture_dds", "KHR_lights_punctual", "ADOBE_materials_thin_transparency",
        "KHR_animation_pointer", "EXT_mesh_features", "KHR_xmp_json_ld"})
    EXPECT_EQ(error(name), "") << name;
  for (const char* name : {"VENDOR_geometry_magic", "KHR_materials_displacement", "CESIUM_RTC",
                           "materials_unlit", "KHR_gaussian_splatting", "x", ""})
    EXPECT_EQ(error(name), "sample.mesh: it requires the glTF extension " + std::string(name) +
                               ", which is unknown here and may change its shape; export it without that")
        << name;
  // Those that are only used may be ignored.
  const std::string used =
      replaced(gltf(R"("byteLength":60)"), "{", R"({"extensionsUsed":["VENDOR_geometry_magic"],)");
  EXPECT_EQ(errorOf(readGltf, glb(used)), "");
}

TEST(GltfExtensions, HidesNodesAndTheirChildren) {
  const auto node = [](const std::string& visible, const std::string& rest) {
    return R"({"extensions":{"KHR_node_visibility":{)" + visible + "}}," + rest + "}";
  };
  const auto hidden = [&](const std::string& visible) {
    return read(readGltf, glb(gltf(R"("byteLength":60)",
                                   R"({"children":[1,3]},)" + node(visible, R"("mesh":0,"children":[2])") +
                                       "," + node(R"("visible":true)", R"("mesh":0)") + R"(,{"mesh":0})")));
  };
  EXPECT_EQ(hidden(R"("visible":false)").mesh.triangles.size(), 2u);
  EXPECT_EQ(hidden(R"("visible":false)").warnings,
            "sample.mesh: 2 nodes with a mesh left out, for the file hides them\n");
  EXPECT_EQ(hidden(R"("visible":true)").mesh.triangles.size(), 6u);
  EXPECT_EQ(hidden("").mesh.triangles.size(), 6u);
  EXPECT_EQ(hidden("").warnings, "");
}

TEST(GltfScenes, TheFirstIsReadIfNoneIsTheDefault) {
  const auto reading = [](const std::string& scenes) {
    return read(readGltf,
                glb(replaced(gltf(R"("byteLength":60)", R"({"mesh":0},{"mesh":0,"translation":[5,0,0]})"),
                             R"("scene":0,"scenes":[{"nodes":[0]}])", scenes)));
  };
  const samples::Reading two = reading(R"("scenes":[{"nodes":[1]},{"nodes":[0,1]}])");
  EXPECT_EQ(two.mesh.triangles.size(), 2u);
  EXPECT_EQ(bounds(two.mesh).min.x, 5);
  EXPECT_EQ(two.warnings, "sample.mesh: it has 2 scenes and names none as its default: the first is read\n");
  const samples::Reading second = reading(R"("scene":1,"scenes":[{"nodes":[1]},{"nodes":[0,1]}])");
  EXPECT_EQ(second.mesh.triangles.size(), 4u);
  EXPECT_EQ(second.warnings, "");
  const samples::Reading one = reading(R"("scenes":[{"nodes":[1]}])");
  EXPECT_EQ(one.mesh.triangles.size(), 2u);
  EXPECT_EQ(one.warnings, "");
  EXPECT_EQ(reading(R"("asset":{})").mesh.triangles.size(), 4u);
}

TEST(GltfSparse, NeedsNoBufferView) {
  const std::string sparse =
      R"({"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":3,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":0,"byteOffset":12}}})";
  std::string text = replaced(gltf(R"("byteLength":63)"),
                              R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})", sparse);
  text = replaced(text, R"("byteOffset":48,"byteLength":12})",
                  R"("byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":3})");
  const std::string buffer = samples::gltfBuffer() + "\1\2\3";
  EXPECT_TRUE(samples::isSquare(read(readGltf, glb(text, buffer)).mesh));
  EXPECT_TRUE(contains(errorOf(readGltf, glb(replaced(text, R"("count":4)", R"("count":400000000)"), buffer)),
                       "stand for at least 9155 MiB"));
  EXPECT_TRUE(contains(errorOf(readGltf, glb(replaced(text, "\"sparse\"", "\"sparsely\""), buffer)),
                       "accessors[0] has no bufferView"));
}

/// Expects a tube of octagons, closed, of 64 triangles and the volume 336, to 0.01 %.
void expectTube(const Mesh& mesh) {
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.triangles, 64u);
  EXPECT_TRUE(found.watertight);
  EXPECT_NEAR(found.signedVolume, 336, 0.03);
  const Box box = bounds(mesh);
  EXPECT_NEAR(glm::distance(box.min, glm::dvec3(-3, -3, 0)), 0, 1e-3);
  EXPECT_NEAR(glm::distance(box.max, glm::dvec3(3, 3, 12)), 0, 1e-3);
}

const std::filesystem::path kTubes = RAYMAP_TEST_DATA;
std::vector<std::string> tubeFiles() {
  std::vector<std::string> names{"tube.gltfpack_ext.glb", "tube.gltfpack_khr.glb"};
#ifdef RAYMAP_TEST_DRACO
  names.insert(names.end(), {"tube.draco_edgebreaker.glb", "tube.draco_sequential.glb"});
#endif
  return names;
}

std::string dataFile(const std::string& name) {
  std::ifstream file(kTubes / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// data/make_compressed.mjs made these files.
TEST(GltfCompression, IsDecoded) {
  for (const std::string& name : tubeFiles()) {
    SCOPED_TRACE(name);
    expectTube(readMesh(kTubes / name));
  }
}

// gltf-transform leaves the scale of positions that it quantizes to the skin.
TEST(GltfCompression, ScalesQuantizedPositionsByTheirSkin) {
  const std::string whole = dataFile("tube.gltfpack_ext.glb");
  // Without the transform of the node, the skin alone has the scale.
  const std::string text = replaced(whole, R"("translation":[-3,-3,0])", R"("tronslation":[-3,-3,0])");
  expectTube(read(readGltf, replaced(text, R"("scale":[)", R"("scole":[)")).mesh);
}

TEST(GltfCompression, IsDecodedForAnimations) {
  for (const std::string& name : tubeFiles()) {
    SCOPED_TRACE(name);
    const AnimatedMesh mesh = readAnimatedMesh(kTubes / name);
    expectTube(posed(mesh, 0.0));
    // Its upper half has made a quarter turn about x.
    const Box box = bounds(posed(mesh, 1.0));
    EXPECT_NEAR(glm::distance(box.min, glm::dvec3(-3, -6, 0)), 0, 2e-3);
    EXPECT_NEAR(glm::distance(box.max, glm::dvec3(3, 3, 9)), 0, 2e-3);
  }
}

TEST(GltfCompression, IsDecodedForInstances) {
  const Mesh mesh = readMesh(kTubes / "tubes.meshopt.glb");
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.triangles, 192u);
  EXPECT_EQ(found.components, 3u);
  EXPECT_TRUE(found.watertight);
  EXPECT_NEAR(found.signedVolume, 336 * (1 + 8 + 1), 2);
  EXPECT_NEAR(bounds(mesh).max.z, 24, 0.01);
}

TEST(GltfCompression, SurvivesAnyByte) {
  const std::string whole = dataFile("tube.gltfpack_khr.glb");
  size_t refused = 0;
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 == 0 ? 0xff : 0x05));
    const MeshFile file{std::as_bytes(std::span(damaged)), "a.glb", {}};
    try {
      validate(readGltf(file));
      validate(readAnimatedGltf(file));
    } catch (const Error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("a.glb: ")) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, whole.size() / 4);
}

TEST(GltfCompression, NamesWhatIsWrongWithMeshopt) {
  const std::string whole = dataFile("tube.gltfpack_ext.glb");
  const auto error = [&](const std::string& from, const std::string& to) {
    return errorOf(readGltf, replaced(whole, from, to));
  };
  EXPECT_EQ(errorOf(readGltf, whole), "");
  EXPECT_TRUE(
      contains(error(R"("mode":"ATTRIBUTES")", R"("mode":"INDICES"   )"),
               "bufferViews[0]: its compressed data (meshopt, mode INDICES) are damaged or cut short"));
  EXPECT_TRUE(
      contains(error(R"("mode":"TRIANGLES")", R"("mode":"TRI"      )"), "(meshopt, mode TRI) are damaged"));
  EXPECT_TRUE(contains(error(R"("count":34)", R"("count":35)"), "is compressed from 35 elements of 8 bytes"));
  EXPECT_TRUE(contains(error("\xa0", "\xa2"), "bufferViews[0]: its compressed data"));
}

/// Returns the square many times: `nodes` nodes show a mesh of `primitives` primitives.
std::string multiplied(size_t nodes, size_t primitives) {
  std::string list, all, roots;
  for (size_t i = 0; i < nodes; ++i) list += (i ? "," : "") + std::string(R"({"mesh":0})");
  for (size_t i = 0; i < nodes; ++i) roots += (i ? "," : "") + std::to_string(i);
  const std::string one = R"("attributes":{"POSITION":0},"indices":1)";
  for (size_t i = 0; i < primitives; ++i) all += (i ? "},{" : "") + one;
  return glb(replaced(gltf(R"("byteLength":60)", list, all), R"("nodes":[0])", R"("nodes":[)" + roots + "]"));
}

TEST(GltfSize, IsBoundedByTheFile) {
  EXPECT_EQ(read(readGltf, multiplied(100, 100)).mesh.triangles.size(), 20000u);
  for (const std::string& bytes :
       {multiplied(3000, 3000), replaced(multiplied(3000, 3000), R"("count":4)", R"("count":0)")}) {
    const std::string error = errorOf(readGltf, bytes);
    EXPECT_TRUE(contains(error, "bytes stand for at least ")) << error;
    EXPECT_TRUE(contains(
        error, " MiB of vertices and triangles, as instances or compressed; of a file of this size at most "))
        << error;
  }
}

#ifdef RAYMAP_TEST_DRACO

/// Writes bytes as a file and returns the error of reading it, without the file's name.
std::string errorOfGlb(const std::string& bytes) {
  const samples::TemporaryFile file("a.glb", bytes);
  try {
    readMesh(file.path());
  } catch (const Error& error) {
    return std::string(error.what()).substr(file.path().string().size() + 2);
  }
  return {};
}

TEST(GltfDraco, NamesWhatIsWrong) {
  const std::string whole = dataFile("tube.draco_edgebreaker.glb");
  EXPECT_EQ(errorOfGlb(whole), "");
  EXPECT_TRUE(
      contains(errorOfGlb(replaced(whole, "DRACO", "DRAGO")), "its Draco data of mesh 0 are damaged: "));
  EXPECT_EQ(errorOfGlb(replaced(whole, R"("POSITION":0,)", R"("POSITION":9,)")),
            "its Draco data of mesh 0 have no attribute 9");
}

TEST(GltfDraco, ReadsWhatIsThereUncompressed) {
  const std::string extension =
      R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":7,"attributes":{"POSITION":0}}})";
  const std::string primitive = R"("attributes":{"POSITION":0},"indices":1)" + extension;
  EXPECT_TRUE(
      samples::isSquare(read(readGltf, glb(gltf(R"("byteLength":60)", R"({"mesh":0})", primitive))).mesh));
}

TEST(GltfDraco, SurvivesAnyByte) {
  const std::string whole = dataFile("tube.draco_edgebreaker.glb");
  for (size_t at = whole.find("DRACO"); at < whole.size(); at += 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    errorOfGlb(damaged);  // An error, or a mesh that is whole.
  }
}

#endif

}  // namespace
}  // namespace raymap
