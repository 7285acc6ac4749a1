#include <gtest/gtest.h>
#include <raymap/io.h>
#include <sys/stat.h>

#include <fstream>

#include "files.h"
#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::errorOf;
using samples::glb;
using samples::gltf;
using samples::isSquare;
using samples::read;
using samples::replaced;

const std::string kBytes = R"("byteLength":60)";
// samples::gltfBuffer() in base64.
const std::string kDataUri =
    R"("byteLength":60,"uri":"data:application/octet-stream;base64,)"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA\"";

/// Reads the square as these nodes place it.
Mesh squareUnder(const std::string& nodes) {
  return read(readGltf, glb(gltf(kBytes, nodes))).mesh;
}

TEST(ReadGltf, ReadsBinaryEmbeddedAndExternalBuffers) {
  EXPECT_TRUE(isSquare(read(readGltf, glb()).mesh));
  EXPECT_TRUE(isSquare(read(readGltf, gltf(kDataUri)).mesh));
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "square corners.bin", std::ios::binary) << samples::gltfBuffer();
  std::ofstream(folder.path() / "external.gltf") << gltf(R"("byteLength":60,"uri":"square%20corners.bin")");
  EXPECT_TRUE(isSquare(readMesh(folder.path() / "external.gltf")));
}

TEST(ReadGltf, AppliesNodesAndInstances) {
  Box box = bounds(squareUnder(R"({"translation":[10,0,0],"children":[1]},{"scale":[2,3,1],"mesh":0})"));
  EXPECT_EQ(box.min, glm::dvec3(10, 0, 0));
  EXPECT_EQ(box.max, glm::dvec3(12, 3, 0));

  box = bounds(squareUnder(R"({"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,0,0,5,1],"mesh":0})"));
  EXPECT_EQ(box.min, glm::dvec3(-1, 0, 5));
  EXPECT_EQ(box.max, glm::dvec3(0, 1, 5));

  // A quarter turn around z is the same as the matrix above.
  box = bounds(squareUnder(R"({"rotation":[0,0,0.7071067811865476,0.7071067811865476],"mesh":0})"));
  EXPECT_NEAR(box.min.x, -1, 1e-7);
  EXPECT_NEAR(box.max.y, 1, 1e-7);

  const Mesh both = squareUnder(R"({"children":[1,2]},{"mesh":0},{"mesh":0,"translation":[0,0,7]})");
  EXPECT_EQ(both.triangles.size(), 4u);
  EXPECT_EQ(bounds(both).max.z, 7.0);
}

TEST(ReadGltf, TurnsMirroredInstancesOutwards) {
  EXPECT_EQ(samples::areaVector(squareUnder(R"({"scale":[-1,1,1],"mesh":0})")), glm::dvec3(0, 0, 1));
}

TEST(ReadGltf, TakesAllRootsWithoutAScene) {
  const std::string text = replaced(gltf(kBytes, R"({"mesh":0},{"children":[2]},{"mesh":0})"),
                                    R"("scene":0,"scenes":[{"nodes":[0]}],)", "");
  EXPECT_EQ(read(readGltf, glb(text)).mesh.triangles.size(), 4u);
}

TEST(ReadGltf, ReadsStripsFansAndPlainVertices) {
  const auto withPrimitive = [](const std::string& primitive) {
    return read(readGltf, glb(gltf(kBytes, R"({"mesh":0})", R"("attributes":{"POSITION":0},)" + primitive)));
  };
  EXPECT_TRUE(isSquare(withPrimitive(R"("mode":6)").mesh));
  EXPECT_EQ(withPrimitive(R"("mode":5)").mesh.triangles.size(), 2u);
  EXPECT_TRUE(contains(withPrimitive(R"("mode":4)").warnings, "ends within a triangle"));
  const std::string lines =
      gltf(kBytes, R"({"mesh":0})",
           R"("attributes":{"POSITION":0},"mode":1},{"attributes":{"POSITION":0},"mode":6)");
  EXPECT_TRUE(contains(read(readGltf, glb(lines)).warnings, "1 primitive of points or lines"));
}

TEST(ReadGltf, ReadsSparseAndNormalizedAccessors) {
  // The third corner replaces the first.
  const std::string sparse =
      R"("count":4,"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0,"byteOffset":24}})";
  const Mesh moved = read(readGltf, glb(replaced(gltf(kBytes), R"("count":4)", sparse))).mesh;
  EXPECT_EQ(moved.position(0), glm::dvec3(1, 1, 0));

  std::string corners;
  for (const uint8_t c : {0, 0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 0}) corners += static_cast<char>(c);
  corners.resize(48);
  const std::string bytes = replaced(gltf(kBytes), "5126", R"(5121,"normalized":true)");
  EXPECT_TRUE(isSquare(read(readGltf, glb(bytes, corners + samples::gltfBuffer().substr(48))).mesh));
}

TEST(ReadGltf, NamesWhatIsWrong) {
  const auto error = [](const std::string& from, const std::string& to,
                        const std::string& nodes = R"({"mesh":0})") {
    return errorOf(readGltf, glb(replaced(gltf(kBytes, nodes), from, to)));
  };
  EXPECT_TRUE(
      contains(error(R"("count":4)", R"("count":5)"), "accessors[0] has 5 elements of 12 bytes from byte 0"));
  EXPECT_TRUE(
      contains(error(R"("count":4)", R"("count":4000000000)"), "accessors[0] has 4000000000 elements"));
  EXPECT_TRUE(contains(error(R"("count":4)", R"("count":-4)"), "'count' is not a count"));
  EXPECT_TRUE(contains(error(R"("count":4)", R"("count":18446744073709551615)"), "'count' is not a count"));
  EXPECT_TRUE(
      contains(error(R"("count":4)", R"("count":3)"), "vertex 3 is out of range (it has 3 vertices)"));
  EXPECT_TRUE(contains(error(R"("byteOffset":48)", R"("byteOffset":49)"), "covers bytes 49 to 61"));
  EXPECT_TRUE(contains(error(kBytes, R"("byteLength":61)"), "buffer 0 announces 61 bytes, but has 60"));
  EXPECT_TRUE(contains(error("5126", "5130"), "unknown componentType 5130"));
  EXPECT_TRUE(contains(error("VEC3", "VEC2"), "should have type VEC3"));
  EXPECT_TRUE(
      contains(error(R"("indices":1)", R"("indices":2)"), "accessors[2] does not exist: the file has 2"));
  EXPECT_TRUE(contains(error(R"("nodes":[0])", R"("nodes":[7])"), "nodes[7] does not exist"));
  EXPECT_TRUE(
      contains(error("", "", R"({"children":[1]},{"children":[0],"mesh":0})"), "nodes[0] is reached twice"));
  EXPECT_TRUE(contains(
      error(R"("scene":0,"scenes":[{"nodes":[0]}],)", "", R"({"children":[1]},{"children":[0],"mesh":0})"),
      "cycle"));
  EXPECT_TRUE(contains(errorOf(readGltf, R"({"asset")"), "no valid JSON: line 1, column 9: "));
  EXPECT_TRUE(contains(errorOf(readGltf, "{\n \"a\": nothing}"), "no valid JSON: line 2, column 8: "));
  EXPECT_FALSE(contains(errorOf(readGltf, R"({"asset")"), "json.exception"));
  EXPECT_TRUE(contains(errorOf(readGltf, "[]"), "its JSON is not an object"));
  EXPECT_EQ(errorOf(readGltf, "{}"), "sample.mesh: the file has no triangles");
}

TEST(ReadGltf, FetchesNothingFromElsewhere) {
  for (const char* uri : {"http://127.0.0.1/a.bin", "file:///etc/passwd", "C:a.bin", "a%00.bin", ""})
    EXPECT_TRUE(contains(errorOf(readGltf, gltf(R"("byteLength":1,"uri":")" + std::string(uri) + "\"")),
                         "it refers to '" + std::string(uri) + "'; only files in its own folder are read"))
        << uri;
  EXPECT_TRUE(contains(errorOf(readGltf, gltf(R"("byteLength":60,"uri":"missing.bin")")),
                       "missing.bin: cannot read"));
}

/// A folder with a glTF file whose buffer has a URI, and a folder beside it.
class GltfWithUri : public ::testing::Test {
 protected:
  void SetUp() override {
    create_directories(inside("sub"));
    create_directories(outside("own-not"));  // Its name begins as that of the folder.
    for (const auto& path : {inside("buffer.bin"), inside("sub/..bin"), outside("own-not/buffer.bin")})
      std::ofstream(path, std::ios::binary) << samples::gltfBuffer();
  }
  std::filesystem::path outside(const std::string& name) const { return folder_.path() / name; }
  std::filesystem::path inside(const std::string& name) const { return folder_.path() / "own" / name; }
  Mesh readWith(const std::string& uri, const std::filesystem::path& folder) const {
    std::ofstream(inside("model.gltf")) << gltf(R"("byteLength":60,"uri":")" + uri + "\"");
    return readMesh(folder / "model.gltf");
  }
  std::string errorWith(const std::string& uri) const {
    try {
      readWith(uri, inside(""));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      return error.what();
    }
    return "no error";
  }
  /// Returns the error of a refused file with this name.
  std::string refusal(const std::string& name, const std::string& what) const {
    return inside("").string() + "model.gltf: it refers to '" + name + "', " + what +
           "; only regular files in its own folder are read; copy it there";
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(GltfWithUri, ReadsFilesInItsFolder) {
  create_symlink("../buffer.bin", inside("sub/link.bin"));
  create_directory_symlink(inside(""), outside("link"));
  for (const char* uri : {"buffer.bin", "./buffer.bin", "sub/..bin", "sub%2F..bin", "sub/link.bin"})
    for (const auto& folder : {inside(""), outside("link")})
      EXPECT_TRUE(isSquare(readWith(uri, folder))) << uri << " in " << folder;
  const std::filesystem::path before = std::filesystem::current_path();
  current_path(inside(""));
  EXPECT_TRUE(isSquare(readWith("sub/link.bin", "")));
  current_path(before);
}

TEST_F(GltfWithUri, RefusesFilesOutsideItsFolder) {
  for (const char* uri : {"../own-not/buffer.bin", "..%2Fown-not/buffer.bin", "%2e%2e/own-not/buffer.bin",
                          "sub/../../own-not/buffer.bin"}) {
    const std::string name =
        std::string(std::string(uri).starts_with("sub") ? "sub/../" : "") + "../own-not/buffer.bin";
    EXPECT_EQ(errorWith(uri), refusal(name, "a file outside its folder")) << uri;
  }
  const std::string absolute = inside("buffer.bin").string();
  EXPECT_EQ(errorWith(absolute), refusal(absolute, "a file outside its folder"));
  EXPECT_EQ(errorWith("%2Fetc%2Fpasswd"), refusal("/etc/passwd", "a file outside its folder"));
}

TEST_F(GltfWithUri, RefusesLinksOutOfItsFolder) {
  create_symlink("../own-not/buffer.bin", inside("link.bin"));
  create_symlink(outside("own-not/buffer.bin"), inside("sub/link.bin"));
  create_directory_symlink("../own-not", inside("folder"));
  for (const char* name : {"link.bin", "sub/link.bin", "folder/buffer.bin"})
    EXPECT_EQ(errorWith(name), refusal(name, "a link out of its folder"));
}

TEST_F(GltfWithUri, RefusesWhatIsNoRegularFile) {
  ASSERT_EQ(mkfifo(inside("pipe").c_str(), 0600), 0);
  for (const char* name : {"pipe", "sub", "."})
    EXPECT_EQ(errorWith(name), refusal(name, "which is not a regular file"));
}

}  // namespace
}  // namespace raymap
