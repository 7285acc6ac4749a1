#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

/// Checks that a mesh has the same triangles, in the same order and with the same first corners.
void expectSame(const Mesh& read, const Mesh& written, double tolerance) {
  ASSERT_EQ(read.triangles.size(), written.triangles.size());
  for (size_t t = 0; t < read.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p = read.position(read.triangles[t][c]), q = written.position(written.triangles[t][c]);
      for (int a = 0; a < 3; ++a) ASSERT_NEAR(p[a], q[a], tolerance) << t;
    }
}

class WriteMesh : public testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path path() const { return folder_.path() / ("mesh" + std::string(GetParam())); }
  bool hasShared() const { return std::string(GetParam()) != ".stl"; }

 private:
  TemporaryFolder folder_;
};

TEST_P(WriteMesh, IsReadAgain) {
  const Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  writeMesh(path(), mesh);
  std::string warnings;
  const Mesh read = readMesh(path(), [&](std::string_view text) { warnings += text; });
  EXPECT_EQ(warnings, "");
  expectSame(read, mesh, 1e-7);
  if (hasShared()) {
    EXPECT_TRUE(read.triangles == mesh.triangles);
  }
  const Diagnostics found = diagnose(read);
  EXPECT_TRUE(found.watertight);
  EXPECT_GT(found.signedVolume, 0.0);
  writeMesh(path(), read);
  expectSame(readMesh(path()), read, 0.0);
}

TEST_P(WriteMesh, LosesNothingFarAway) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  mesh.origin = {1e6, -3e6, 0.1};
  writeMesh(path(), mesh);
  expectSame(readMesh(path()), mesh, hasShared() ? 1e-7 : 0.25);  // An STL holds seven digits.
}

TEST_P(WriteMesh, HoldsWhatAsStoredSays) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  mesh.origin = {1e6, -3e6, 0.1};
  for (const glm::dvec3& offset : {glm::dvec3(0.0), glm::dvec3(1e6, -3e6, 0.0)}) {
    writeMesh(path(), mesh, {offset});
    Mesh read = readMesh(path());
    read.origin += offset;
    expectSame(read, asStored(path(), mesh, {offset}), 1e-8);
    // Only what is far from 0 in an STL loses digits.
    const bool isCoarse = !hasShared() && offset.x == 0.0;
    double largest = 0.0;
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
      largest =
          std::max(largest, glm::distance(asStored(path(), mesh, {offset}).position(v), mesh.position(v)));
    EXPECT_EQ(largest > 0.03, isCoarse) << largest;
    EXPECT_EQ(largest > 1e-6, isCoarse) << largest;
  }
}

TEST_P(WriteMesh, NotesTheOffset) {
  const Mesh mesh = shapes::box({10.5, 20.0, -30.25}, {11.5, 21.0, -29.25});
  const auto written = [&](const glm::dvec3& offset) {
    writeMesh(path(), mesh, {offset});
    return readBytes(path());
  };
  EXPECT_EQ(written(glm::dvec3(0.0)).find("offset "), std::string::npos);
  const char* note = GetParam() == std::string(".glb") ? "\"extras\":{\"offset\":[11.0,20.0,-30.25]}"
                                                       : "offset 11 20 -30.25";
  EXPECT_NE(written({11.0, 20.0, -30.25}).find(note), std::string::npos);
  const Box box = bounds(readMesh(path()));
  EXPECT_EQ(box.min, glm::dvec3(-0.5, 0.0, 0.0));
  EXPECT_EQ(box.max, glm::dvec3(0.5, 1.0, 1.0));
  EXPECT_THROW(writeMesh(path(), mesh, {glm::dvec3(0.0, NAN, 0.0)}), Error);
}

INSTANTIATE_TEST_SUITE_P(Formats, WriteMesh, testing::Values(".ply", ".obj", ".stl", ".glb"),
                         [](const auto& test) { return std::string(test.param).substr(1); });

TEST(WriteMeshNames, AreChecked) {
  const TemporaryFolder folder;
  const auto codeOf = [&](const char* name, const Mesh& mesh) {
    try {
      writeMesh(folder.path() / name, mesh);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode{};
  };
  const Mesh mesh = shapes::box(glm::dvec3(0.0), glm::dvec3(1.0));
  EXPECT_EQ(codeOf("mesh.fbx", mesh), ErrorCode::Usage);
  EXPECT_EQ(codeOf("mesh.PLY", mesh), ErrorCode{});
  EXPECT_EQ(codeOf("none/mesh.ply", mesh), ErrorCode::File);
  EXPECT_EQ(codeOf("empty.ply", Mesh()), ErrorCode::Input);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "empty.ply"));
}

TEST(WriteMeshView, IsWrittenLikeTheMesh) {
  const Mesh stored = shapes::sphere(1.0, 3, {1e6, -2e6, 3e6});
  std::vector<glm::dvec3> positions;
  for (uint32_t v = 0; v < stored.vertices.size(); ++v) positions.push_back(stored.position(v));
  const TemporaryFolder folder;
  writeMesh(folder.path() / "view.ply", MeshView(positions, stored.triangles));
  writeMesh(folder.path() / "mesh.ply", makeMesh(positions, stored.triangles));
  EXPECT_EQ(readBytes(folder.path() / "view.ply"), readBytes(folder.path() / "mesh.ply"));
}

}  // namespace
}  // namespace raymap
