// Numbers that two formats hold stay the same bits from one to the other.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <random>

#include "contains.h"
#include "files.h"

namespace raymap {
namespace {

/// Result of `readMesh`: a view of the mesh, or of its positions in double precision if it rounds
/// some.
struct ExactRead {
  std::vector<glm::dvec3> exact;
  Mesh mesh;

  explicit ExactRead(const std::filesystem::path& path) : mesh(readMesh(path, {.exact = &exact})) {}
  MeshView view() const { return exact.empty() ? MeshView(mesh) : MeshView(exact, mesh.triangles); }
  /// Returns the corners of all triangles.
  std::vector<glm::dvec3> corners() const {
    std::vector<glm::dvec3> all;
    for (const glm::uvec3& t : mesh.triangles)
      for (int c = 0; c < 3; ++c) all.push_back(exact.empty() ? mesh.position(t[c]) : exact[t[c]]);
    return all;
  }
};

class ExactPositions : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  void convert(const std::string& from, const std::string& to) const {
    writeMesh(path(to), ExactRead(path(from)).view());
  }
  std::string bytes(const std::string& name) const { return readBytes(path(name)); }

  /// Writes an STL of triangles with these corners.
  void writeCorners(const std::string& name, const std::vector<glm::vec3>& corners) const {
    std::vector<glm::uvec3> triangles;
    for (uint32_t v = 0; v < corners.size(); v += 3) triangles.emplace_back(v, v + 1, v + 2);
    writeMesh(path(name), MeshView(corners, triangles));
  }

 private:
  TemporaryFolder folder_;
};

/// Returns corners of 30 triangles of many sizes about an offset, 0 and denormal numbers among them.
std::vector<glm::vec3> manyFloats(float offset, float scale) {
  std::mt19937 random(1);
  std::normal_distribution<float> distribution;
  std::vector<glm::vec3> corners(90);
  for (size_t v = 0; v < corners.size(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      corners[v][axis] = offset + scale * distribution(random) * (v % 7 == 0 ? 1e-6F : 1.0F);
  corners[4] = {0.0F, 1e-42F, offset};
  return corners;
}

TEST_F(ExactPositions, OfFloatsStayThroughAllFormats) {
  for (const auto& [offset, scale] :
       {std::pair{0.0F, 1.0F}, {0.3F, 1.0F}, {500000.0F, 100.0F}, {0.0F, 1e-20F}}) {
    const std::vector<glm::vec3> corners = manyFloats(offset, scale);
    writeCorners("a.stl", corners);
    const std::string given = bytes("a.stl");
    for (const char* through : {"b.stl", "b.obj", "b.ply", "b.glb", "b.3mf"}) {
      convert("a.stl", through);
      convert(through, "c.stl");
      EXPECT_TRUE(bytes("c.stl") == given) << through << offset;
      convert(through, "again" + std::filesystem::path(through).extension().string());
      EXPECT_TRUE(ExactRead(path(through)).corners() ==
                  ExactRead(path("again" + std::string(through + 1))).corners());
    }
  }
}

TEST_F(ExactPositions, WrittenTwiceAreTheSameBytes) {
  writeCorners("a.stl", manyFloats(0.3F, 1.0F));
  for (const char* name : {".stl", ".obj", ".ply", ".glb"}) {
    const std::string end(name);
    convert("a.stl", "b" + end);
    convert("b" + end, "c" + end);
    EXPECT_TRUE(bytes("b" + end) == bytes("c" + end)) << end;
  }
}

constexpr const char* kSlab =
    "v 0.3 -0.25 0\nv -1.7 -0.25 0\nv -1.7 0.25 -0\nv 0.3 0.25 0\nv -1.7 0.25 0.22\nv 1e-30 0.1 123456.789\n"
    "f 1 2 3\nf 3 4 1\nf 4 3 5\n";

TEST_F(ExactPositions, OfDecimalsStayWhereTheFormatHoldsThem) {
  std::ofstream(path("a.obj")) << kSlab;
  convert("a.obj", "b.obj");
  EXPECT_EQ(bytes("b.obj"), kSlab) << "-0 and the vertex that no face uses, too";
  convert("a.obj", "b.ply");
  convert("b.ply", "c.obj");
  EXPECT_EQ(bytes("c.obj"), kSlab);
  convert("a.obj", "b.3mf");
  convert("b.3mf", "c.obj");
  std::string zeros(kSlab);
  zeros.erase(zeros.find("-0\n"), 1);  // Those of a 3MF have no sign.
  EXPECT_EQ(bytes("c.obj"), zeros);
  convert("a.obj", "b.stl");
  const std::vector<glm::dvec3> corners = ExactRead(path("a.obj")).corners(),
                                rounded = ExactRead(path("b.stl")).corners();
  for (size_t c = 0; c < corners.size(); ++c) EXPECT_EQ(rounded[c], glm::dvec3(glm::vec3(corners[c]))) << c;
}

TEST_F(ExactPositions, OfDecimalsChangeOnceInAGlb) {
  std::ofstream(path("a.obj")) << kSlab;
  convert("a.obj", "b.glb");
  convert("b.glb", "c.glb");
  EXPECT_TRUE(bytes("b.glb") == bytes("c.glb"));
  EXPECT_EQ(ExactRead(path("b.glb")).corners()[0].z, 0.0);
}

TEST_F(ExactPositions, OfAnStlWithTextAreJoinedAsGiven) {
  std::ofstream(path("a.stl"))
      << "solid\nfacet normal 0 0 1\nouter loop\nvertex 0.1 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
         "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0.1 0 0\n"
         "vertex 0 1 0.3\nvertex 0.10000000000000002 0 0\nendloop\nendfacet\nendsolid\n";
  convert("a.stl", "b.3mf");
  const ExactRead read(path("b.3mf"));
  EXPECT_EQ(read.mesh.vertices.size(), 5u);
  EXPECT_EQ(read.corners()[0].x, 0.1);
  EXPECT_EQ(read.corners()[3].x, 0.1);
  EXPECT_EQ(read.corners()[4].z, 0.3);
  EXPECT_EQ(read.corners()[5].x, 0.10000000000000002);
}

TEST_F(ExactPositions, AreGivenOnlyWhereTheMeshRoundsThem) {
  std::vector<glm::dvec3> exact(3);
  std::ofstream(path("a.obj")) << "v 0 0 0\nv 1 0 0\nv 0 0.5 0\nf 1 2 3\n";
  readMesh(path("a.obj"), {.exact = &exact});
  EXPECT_TRUE(exact.empty());
  std::ofstream(path("b.obj")) << "v 0 0 0\nv 1 0 0\nv 0 0.1 0\nf 1 2 3\n";
  readMesh(path("b.obj"), {.exact = &exact});
  EXPECT_TRUE(exact == (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}}));
}

TEST_F(ExactPositions, OfAViewAreMovedByTheOffset) {
  const std::vector<glm::dvec3> positions{{1000.1, 0, 0}, {1001, 0, 0}, {1000, 1, 0.3}};
  const std::vector<glm::uvec3> triangles{{0, 1, 2}};
  writeMesh(path("a.obj"), MeshView(positions, triangles, {5, 0, 0}), {.offset = {1000, 0, 0}});
  EXPECT_TRUE(contains(bytes("a.obj"), "v 5.100000000000023 0 0\nv 6 0 0\nv 5 1 0.3\n")) << bytes("a.obj");
  const Mesh stored = asStored(path("a.obj"), MeshView(positions, triangles));
  EXPECT_EQ(stored.origin, makeMesh(positions, triangles).origin);
}

TEST_F(ExactPositions, OfAFarVertexAreNamed) {
  std::ofstream(path("cube.off"))
      << "OFF\n8 12 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1e19\n0 1 1\n"
         "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 2 3 7\n3 2 7 6\n"
         "3 1 2 6\n3 1 6 5\n3 0 4 7\n3 0 7 3\n";
  std::vector<Warning> warnings;
  const Mesh mesh = readMesh(path("cube.off"), {.warn = [&](const Warning& w) { warnings.push_back(w); }});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::FarVertices);
  EXPECT_EQ(warnings[0].message, path("cube.off").string() +
                                     ": 1 vertex lies 10^9 sizes of the mesh or more away from the others: "
                                     "vertex 6 (used by triangle 2) "
                                     "at (1, 1, 1e+19), 1e+19 sizes away; correct it, or remove its faces");
  EXPECT_EQ(warnings[0].fields.count, 1u);
  EXPECT_EQ(warnings[0].fields.length, 1e19);
  EXPECT_EQ(mesh.position(4), glm::dvec3(0, 0, 1)) << "the others keep their positions";
  EXPECT_EQ(diagnose(mesh).farVertices, 1u);
}

}  // namespace
}  // namespace raymap
