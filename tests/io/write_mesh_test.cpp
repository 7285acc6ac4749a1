#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "contains.h"
#include "error_code.h"
#include "files.h"
#include "io/3mf/zip_parts.h"
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
  const Mesh read = readMesh(path(), {.warn = [&](const Warning& warning) { warnings += warning.message; }});
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

TEST_P(WriteMesh, SaysHowFarRoundingMovesVertices) {
  std::string warnings;
  const auto written = [&](const Mesh& mesh, const glm::dvec3& offset = glm::dvec3(0.0)) {
    warnings.clear();
    writeMesh(path(), mesh,
              {.offset = offset, .warn = [&](const Warning& warning) { warnings += warning.message; }});
    return warnings;
  };
  // Between 256 and 512, numbers of single precision are 3.05e-5 apart.
  const auto moving = [](float shift, const glm::vec3& last) {
    return Mesh{
        {{0, 0, 0}, {1, 0, 0}, last + glm::vec3(shift, 0, 0), {0.1F, 99, 0}}, {{0, 1, 2}}, {256, 0, 0}};
  };
  const std::string expected =
      path().string() +
      ": so far from (0, 0, 0), the single precision of this format moves vertices by up to 1.25e-05, "
      "0.00125 % "
      "of the mesh's size; write one of .ply .obj .glb .3mf, or move the mesh closer";
  EXPECT_EQ(written(moving(1.25e-5F, {0, 1, 0})), hasShared() ? "" : expected);
  EXPECT_EQ(written(moving(1.25e-5F, {0, 1, 0}), {256, 0, 0}), "") << "after the offset";
  EXPECT_EQ(written(moving(0.99e-5F, {0, 1, 0})), "");
  for (const glm::vec3& last : {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}})
    EXPECT_EQ(written(moving(1.25e-5F, last)), "") << "of the longest side";
  if (hasShared()) return;
  const glm::vec3 point(1e-6F, 0, 0);
  EXPECT_EQ(written({{point, point, point}, {{0, 1, 2}}, {256, 0, 0}}), "") << "a point has no shape";
}

/// Returns the content of a part of a 3MF.
std::string partOf(const std::filesystem::path& path, const std::string& name) {
  const std::string bytes = readBytes(path);
  std::string content;
  ZipParts({std::as_bytes(std::span(bytes)), path, {}}).read(name, [&](std::string_view piece) {
    content += piece;
  });
  return content;
}

TEST_P(WriteMesh, NotesTheOffset) {
  const Mesh mesh = shapes::box({10.5, 20.0, -30.25}, {11.5, 21.0, -29.25});
  const auto written = [&](const glm::dvec3& offset) {
    writeMesh(path(), mesh, {offset});
    return GetParam() == std::string(".3mf") ? partOf(path(), "3D/3dmodel.model") : readBytes(path());
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

INSTANTIATE_TEST_SUITE_P(Formats, WriteMesh, testing::Values(".ply", ".obj", ".stl", ".glb", ".3mf"),
                         [](const auto& test) { return std::string(test.param).substr(1); });

TEST(WriteMeshNames, AreChecked) {
  const TemporaryFolder folder;
  const auto refusal = [&](const char* name, const Mesh& mesh) {
    return codeOf([&] { writeMesh(folder.path() / name, mesh); });
  };
  const Mesh mesh = shapes::box(glm::dvec3(0.0), glm::dvec3(1.0));
  EXPECT_EQ(refusal("mesh.fbx", mesh), ErrorCode::Usage);
  EXPECT_EQ(refusal("mesh.PLY", mesh), std::nullopt);
  EXPECT_EQ(refusal("none/mesh.ply", mesh), ErrorCode::File);
  EXPECT_EQ(refusal("empty.ply", Mesh()), ErrorCode::Input);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "empty.ply"));
}

TEST(Write3mf, HoldsUnitMetadataAndAllDigits) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a <b> & \xc3\xa9\xff\x01.3mf";
  const Mesh mesh{
      {{0.1F, 0, -2}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, INFINITY}}, {{0, 1, 2}, {1, 1, 2}}, {1e6, 0, 1e-3}};
  writeMesh(path, mesh, {.unit = LengthUnit::Inch});
  EXPECT_EQ(partOf(path, "3D/3dmodel.model"),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<model unit=\"inch\" xml:lang=\"en-US\" "
            "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
            "<metadata name=\"Title\">a &lt;b&gt; &amp; \xc3\xa9?"
            "?</metadata>\n"
            "<metadata name=\"Application\">raymap " +
                std::string(version().text) +
                "</metadata>\n<resources>\n<object id=\"1\" type=\"model\">\n<mesh>\n<vertices>\n"
                "<vertex x=\"1000000.1000000015\" y=\"0\" z=\"-1.999\"/>\n<vertex x=\"1000001\" y=\"0\" "
                "z=\"0.001\"/>\n"
                "<vertex x=\"1e+06\" y=\"1\" z=\"0.001\"/>\n<vertex x=\"0\" y=\"0\" z=\"0\"/>\n"
                "</vertices>\n<triangles>\n<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>\n</triangles>\n"
                "</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"1\"/>\n</build>\n</model>\n");
  std::string warnings;
  const Mesh read = readMesh(path, {.warn = [&](const Warning& warning) { warnings += warning.message; }});
  EXPECT_TRUE(contains(warnings, "is in the unit inch; converted to millimetres"));
  EXPECT_NEAR(read.position(1).x, 1000001 * 25.4, 1e-6);
}

TEST(Write3mf, StatesEachUnit) {
  const TemporaryFolder folder;
  const Mesh mesh = shapes::box(glm::dvec3(0.0), glm::dvec3(1.0));
  for (const LengthUnit unit : {LengthUnit::Micron, LengthUnit::Millimetre, LengthUnit::Centimetre,
                                LengthUnit::Inch, LengthUnit::Foot, LengthUnit::Metre}) {
    writeMesh(folder.path() / "box.3mf", mesh, {.unit = unit});
    EXPECT_NEAR(bounds(readMesh(folder.path() / "box.3mf")).max.y, millimetres(unit),
                1e-6 * millimetres(unit));
  }
}

TEST(Write3mf, JoinsThePositionsOfAnStl) {
  const TemporaryFolder folder;
  const Mesh torus = shapes::torus(2.0, 0.7, 40, 24);
  writeMesh(folder.path() / "torus.stl", torus);
  const Mesh soup = readMesh(folder.path() / "torus.stl");
  ASSERT_EQ(soup.vertices.size(), 3 * torus.triangles.size());
  writeMesh(folder.path() / "torus.3mf", soup);
  const Mesh read = readMesh(folder.path() / "torus.3mf");
  EXPECT_EQ(read.vertices.size(), torus.vertices.size());
  expectSame(read, soup, 0.0);
}

TEST(Write3mf, KeepsEqualPositionsOfAMeshThatSharesVertices) {
  const TemporaryFolder folder;
  // Two triangles share vertex 0; the third one has positions of its own.
  const Mesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {5, 5, 5}, {5, 5, 5}},
      {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}},
      {}};
  writeMesh(folder.path() / "a.3mf", mesh);
  EXPECT_EQ(readMesh(folder.path() / "a.3mf").triangles, mesh.triangles);
  EXPECT_EQ(readMesh(folder.path() / "a.3mf").vertices.size(), 9u);
}

TEST(Write3mf, WritesTheSameBytesAgain) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "torus.3mf";
  writeMesh(path, shapes::torus(2.0, 0.7, 40, 24));
  const std::string first = readBytes(path);
  writeMesh(path, shapes::torus(2.0, 0.7, 40, 24));
  EXPECT_EQ(readBytes(path), first);
}

TEST(Write3mf, RefusesAMeshWithoutAnyTriangleThatItCanHold) {
  const TemporaryFolder folder;
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}, {0, 1, 0}, {1, 1, 0}}, {}};
  try {
    writeMesh(folder.path() / "line.3mf", mesh);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
    EXPECT_TRUE(contains(error.what(), "line.3mf: a 3MF holds triangles of three different vertices"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(MeshUnit, IsThatOfTheFormat) {
  EXPECT_EQ(meshUnit("a.3MF"), LengthUnit::Millimetre);
  for (const char* name : {"a.gltf", "a.glb", "a.dae"}) EXPECT_EQ(meshUnit(name), LengthUnit::Metre);
  for (const char* name : {"a.stl", "a.fbx", "a"}) EXPECT_EQ(meshUnit(name), std::nullopt);
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
