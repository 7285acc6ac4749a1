#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <random>

#include "error_code.h"
#include "files.h"
#include "io/mesh/mesh_file.h"
#include "mesh_samples.h"
#include "samples_3mf.h"
#include "shapes.h"
#include "textured_glb.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;
constexpr uint32_t kNone = MeshAttributes::kNone;

/// Two quads in two objects, with groups, materials and texture coordinates; the last face has none.
const std::string kObj =
    "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\n"
    "vt 0.1 0.2\nvt 0.9 0.2\nvt 0.9 0.8\nvt 0.1 0.8 0\n"
    "o low plate\ng base\nusemtl red paint\nf 1/1 2/2/1 3/-2 4/-1\n"
    "o high\nusemtl blue\nf 5/4 6/3 7/2\nf 5 7 8\n";

class MeshAttributesTest : public ::testing::Test {
 protected:
  Mesh load(const fs::path& path) {
    said_.clear();
    return readMesh(path, {.warn = warn(), .attributes = &found_});
  }
  Mesh loadText(const std::string& name, const std::string& text) {
    std::ofstream(path(name), std::ios::binary) << text;
    return load(path(name));
  }
  void store(const std::string& name, const Mesh& mesh) {
    said_.clear();
    writeMesh(path(name), mesh, {.warn = warn(), .attributes = &found_});
  }
  WarningCallback warn() {
    return [this](const Warning& warning) {
      const std::string folder = folder_.path().string() + "/";
      std::string text = warning.message;
      if (const size_t at = text.find(folder); at != text.npos) text.erase(at, folder.size());
      said_ += std::string(name(warning.code)) + " " + text + "\n";
    };
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  std::string partOf(size_t face) const { return found_.parts.at(found_.partOf.at(face)).object; }
  glm::vec2 uvAt(size_t face, int corner) const {
    return found_.uvs.values.at(found_.uvs.corners.at(face)[corner]);
  }
  glm::vec4 colourAt(size_t face, int corner) const {
    return found_.colours.values.at(found_.colours.corners.at(face)[corner]);
  }

  TemporaryFolder folder_;
  MeshAttributes found_;
  std::string said_;
};

TEST_F(MeshAttributesTest, OfAnObjAreKeptAndWrittenAgain) {
  fs::create_directory(path("out"));
  std::ofstream(path("paint.mtl")) << "newmtl blue\n";
  Mesh mesh = loadText("in.obj", kObj);
  for (const char* turn : {"as given", "written and read again"}) {
    SCOPED_TRACE(turn);
    EXPECT_EQ(said_, "");
    ASSERT_EQ(found_.parts.size(), 2u);
    EXPECT_EQ(found_.parts[0], (MeshPart{"low plate", "base"}));
    EXPECT_EQ(found_.parts[1], (MeshPart{"high", "base"}));
    EXPECT_EQ(found_.partOf, (std::vector<uint32_t>{0, 0, 1, 1}));
    EXPECT_EQ(found_.materials, (std::vector<std::string>{"red paint", "blue"}));
    EXPECT_EQ(found_.materialOf, (std::vector<uint32_t>{0, 0, 1, 1}));
    EXPECT_EQ(uvAt(1, 1), glm::vec2(0.9F, 0.8F));
    EXPECT_EQ(uvAt(2, 0), glm::vec2(0.1F, 0.8F));
    EXPECT_EQ(found_.uvs.corners[3], glm::uvec3(kNone));
    EXPECT_TRUE(found_.colours.corners.empty());
    ASSERT_EQ(found_.libraries.size(), 1u);
    EXPECT_TRUE(fs::equivalent(found_.libraries[0], path("paint.mtl")));
    store("out/out.obj", mesh);
    EXPECT_NE(readBytes(path("out/out.obj")).find("mtllib ../paint.mtl\n"), std::string::npos);
    mesh = load(path("out/out.obj"));
    EXPECT_EQ(mesh.triangles.size(), 4u);
  }
  EXPECT_EQ(readBytes(path("paint.mtl")), "newmtl blue\n");
}

TEST_F(MeshAttributesTest, FollowTheCornersOfPolygonsThatAreCut) {
  for (size_t first = 0; first < samples::kU.size(); ++first) {
    std::string text = samples::cornersOfU("v ") + samples::cornersOfU("vt ") + "f";
    for (size_t c = 0; c < samples::kU.size(); ++c) {
      const std::string corner = std::to_string((first + c) % samples::kU.size() + 1);
      text.append(" ").append(corner).append("/").append(corner);
    }
    const Mesh mesh = loadText("u.obj", "usemtl early\nf 1/1 2/2\n" + text + "\nusemtl late\nf 1 2 3\n");
    EXPECT_TRUE(found_.materialOf.front() == 0 && found_.materialOf.back() == 1);
    for (size_t f = 0; f + 1 < mesh.triangles.size(); ++f)
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(uvAt(f, c), glm::vec2(mesh.position(mesh.triangles[f][c]))) << first << " " << f;
  }
}

TEST_F(MeshAttributesTest, NameFacesThatHaveNoneBehindOthers) {
  const Mesh mesh = loadText("in.obj", kObj);
  found_.partOf[2] = found_.materialOf[2] = kNone;
  store("out.obj", mesh);
  load(path("out.obj"));
  EXPECT_EQ(partOf(2), "added");
  EXPECT_EQ(found_.materials[found_.materialOf[2]], "added");
  EXPECT_EQ(partOf(3), "high");
}

TEST_F(MeshAttributesTest, WriteEachObjectOnce) {
  Mesh mesh = loadText("in.obj", kObj);
  found_.partOf = {1, 0, 1, kNone};
  std::swap(found_.uvs.corners[1], found_.uvs.corners[2]);
  const std::vector<glm::uvec3> given = mesh.triangles;
  store("out.obj", mesh);
  mesh = load(path("out.obj"));
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{given[0], given[2], given[1], given[3]}));
  for (size_t f = 0; f < 4; ++f) EXPECT_EQ(partOf(f), f < 2 ? "high" : f == 2 ? "low plate" : "added");
  EXPECT_EQ(found_.materialOf, (std::vector<uint32_t>{0, 1, 0, 1}));
  EXPECT_EQ(uvAt(1, 1), glm::vec2(0.9F, 0.8F));
}

TEST_F(MeshAttributesTest, OfAnObjThatAreMalformedAreLeftOut) {
  const std::string vertices = "v 0 0 0 0.25 0.5 1\nv 1 0 0 x y z\nv 0 1 0 1\nvt 0 x\nvt\nvt 1 1\n";
  loadText("a.obj", vertices + "f 1/1 2/9 3/-3\nf 1/ 2/x 3/0\nf 1/-4 2/3 3/99999999999999999999\n");
  EXPECT_EQ(said_, "file_content a.obj: 7 texture coordinates missing or malformed, and left out\n");
  EXPECT_EQ(found_.uvs.corners[0], glm::uvec3(0, kNone, 0));
  EXPECT_EQ(found_.uvs.corners[2], glm::uvec3(kNone, 2, kNone));
  EXPECT_EQ(found_.colours.corners[0], glm::uvec3(0, kNone, kNone));
  EXPECT_EQ(colourAt(0, 0), glm::vec4(0.25F, 0.5F, 1.0F, 1.0F));
}

TEST_F(MeshAttributesTest, OfAPlyAreKeptAndWrittenAgain) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float alpha\n"
      "property float s\nproperty float t\nproperty float nx\nproperty float quality\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nend_header\n"
      "0 0 0 255 0 51 1 0.5 0.25 0 7\n1 0 0 0 255 0 0.2 1 0 0 7\n0 1 0 1 2 3 1 0 1 0 7\n3 0 1 2 9\n";
  Mesh mesh = loadText("in.ply", text);
  EXPECT_EQ(found_.lost, (std::vector<std::string>{"quality of vertices", "colours of faces"}));
  for (const char* turn : {"as given", "written and read again"}) {
    SCOPED_TRACE(turn);
    EXPECT_EQ(colourAt(0, 0), glm::vec4(1.0F, 0.0F, 0.2F, 1.0F));
    EXPECT_EQ(colourAt(0, 1), glm::vec4(0.0F, 1.0F, 0.0F, 0.2F));
    EXPECT_EQ(uvAt(0, 0), glm::vec2(0.5F, 0.25F));
    found_.lost.clear();
    store("out.ply", mesh);
    EXPECT_EQ(said_, "");
    mesh = load(path("out.ply"));
  }
  found_.colours.values[1] = {NAN, 9.0F, -1.0F, 1.0F};
  store("odd.ply", mesh);
  load(path("odd.ply"));
  EXPECT_EQ(colourAt(0, 1), glm::vec4(0.0F, 1.0F, 0.0F, 1.0F));
}

TEST_F(MeshAttributesTest, ThatAVertexHasSeveralOfKeepTheFirst) {
  const Mesh mesh = loadText("in.obj",
                             "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 1\n"
                             "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 3/2 2/1 4/1\n");
  found_.colours.corners[1].x = 3;
  store("out.ply", mesh);
  EXPECT_EQ(said_,
            "attributes_lost out.ply: it lacks what the given mesh has: texture coordinates and colours "
            "that differ at a vertex; an .obj keeps texture coordinates\n");
  load(path("out.ply"));
  EXPECT_EQ(colourAt(1, 0), glm::vec4(0.0F, 0.0F, 1.0F, 1.0F));
}

TEST_F(MeshAttributesTest, ThatAFormatLacksAreNamed) {
  const Mesh mesh = loadText("in.obj", kObj);
  found_.lost = {"3 properties of faces"};
  store("out.stl", mesh);
  EXPECT_EQ(said_,
            "attributes_lost out.stl: it lacks what the given mesh has: 2 part names, 2 materials, texture "
            "coordinates and 3 properties of faces; an .obj keeps 2 part names, 2 materials and texture "
            "coordinates\n");
  store("out.obj", mesh);
  EXPECT_EQ(said_, "attributes_lost out.obj: it lacks what the given mesh has: 3 properties of faces\n");
  found_ = {};
  store("out.stl", mesh);
  EXPECT_EQ(said_, "");
}

TEST_F(MeshAttributesTest, OfPartsAreObjectsOfAGlbAnd3mf) {
  // Faces of both parts in turn, and one without a name.
  const Mesh a = shapes::box({0, 0, 0}, {1, 1, 1}), b = shapes::box({5, 0, 0}, {6, 2, 1});
  Mesh mesh = shapes::joined(a, b);
  for (size_t f = 0; f < 12; f += 2) std::swap(mesh.triangles[f], mesh.triangles[f + 12]);
  MeshAttributes named{.parts = {{"a & \"b\""}, {"c", "d"}}};
  for (size_t f = 0; f < 24; ++f) named.partOf.push_back(mesh.triangles[f].x < 8 ? 0 : 1);
  named.partOf[3] = kNone;
  for (const std::string file : {"out.glb", "out.3mf"}) {
    SCOPED_TRACE(file);
    found_ = named;
    store(file, mesh);
    EXPECT_EQ(said_, "");
    const Mesh read = load(path(file));
    ASSERT_EQ(found_.partOf.size(), 24u);
    EXPECT_EQ(found_.parts.size(), 2u);
    for (size_t f = 0; f < 24; ++f)
      EXPECT_EQ(partOf(f), read.position(read.triangles[f].x).x > 2.0 ? "c/d" : "a & \"b\"");
    EXPECT_EQ(read.vertices.size(), 16u);
    EXPECT_NEAR(diagnose(read).signedVolume, 3.0, 1e-6);
    found_ = named;
    found_.partOf[4] = 1 - found_.partOf[4];
    store(file, mesh);
    EXPECT_EQ(said_, "attributes_lost " + file +
                         ": it lacks what the given mesh has: 2 part names; an .obj keeps them\n");
    const Mesh whole = load(path(file));
    EXPECT_EQ(whole.triangles, mesh.triangles);
    EXPECT_TRUE(found_.partOf.empty() || found_.partOf[0] == kNone);
  }
}

/// Two tetrahedra that touch nothing, the second one `shift` away. Its faces have the materials red and
/// glass, the default of the object, and colours. `last` are the XML attributes of the last face.
std::string coloured3mf(const std::string& last, const std::string& shift) {
  std::string xml =
      R"(<basematerials id="7"><base name="red" displaycolor="#FF0000"/>)"
      R"(<base name="a &amp; b" displaycolor="#10203040"/></basematerials>)"
      R"(<m:colorgroup id="8" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">)"
      R"(<m:color color="#00ff00"/><m:color color="#0000FF80"/></m:colorgroup>)"
      R"(<object id="1" pid="7" pindex="1"><mesh><vertices>)";
  for (const char* x : {"0", shift.c_str()}) {
    const std::string at = std::string("x=\"") + x + "\"";
    const double far = std::stod(x) + 3.0;
    xml += "<vertex " + at + R"( y="0" z="0"/><vertex x=")" + std::to_string(far) +
           R"(" y="0" z="0"/><vertex )" + at + R"( y="3" z="0"/><vertex )" + at + R"( y="0" z="3"/>)";
  }
  xml += R"(</vertices><triangles><triangle v1="0" v2="2" v3="1" p1="0"/><triangle v1="0" v2="1" v3="3"/>)"
         R"(<triangle v1="0" v2="3" v3="2" pid="8" p1="1"/>)"
         R"(<triangle v1="1" v2="2" v3="3" pid="8" p1="0" p2="1" p3="0"/>)"
         R"(<triangle v1="4" v2="6" v3="5" p1="0"/><triangle v1="4" v2="5" v3="7" p1="0"/>)"
         R"(<triangle v1="4" v2="7" v3="6" p1="0"/><triangle v1="5" v2="6" v3="7" )" +
         last + "/></triangles></mesh></object>";
  return samples::threeMf(samples::model3mf(xml, {R"(objectid="1")"}));
}

TEST_F(MeshAttributesTest, OfA3mfAreReadWrittenAndReadUnchanged) {
  const Mesh mesh = loadText("in.3mf", coloured3mf(R"(p1="0")", "9"));
  EXPECT_EQ(said_, "");
  for (const std::string file : {"in.3mf", "out.3mf", "out.glb"}) {
    SCOPED_TRACE(file);
    if (file != "in.3mf") store(file, mesh);
    EXPECT_EQ(said_, "");
    Mesh read = load(path(file));
    if (file == "out.glb") {  // Its faces are in the order of materials, and white where they had no colour.
      store("again.3mf", read);
      EXPECT_EQ(said_, "");
      load(path("again.3mf"));
      EXPECT_EQ(found_.materialOf, (std::vector<uint32_t>{0, 0, 0, 0, 0, 1, kNone, kNone}));
      EXPECT_EQ(colourAt(7, 1), glm::vec4(0, 0, 1, 128 / 255.0F));
      continue;
    }
    EXPECT_EQ(found_.lost.size(), 0u);
    EXPECT_EQ(found_.materials, (std::vector<std::string>{"red", "a & b"}));
    EXPECT_EQ(found_.materialOf, (std::vector<uint32_t>{0, 1, kNone, kNone, 0, 0, 0, 0}));
    EXPECT_EQ(colourAt(2, 0), glm::vec4(0, 0, 1, 128 / 255.0F));
    EXPECT_EQ(colourAt(3, 0), glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(colourAt(3, 1), glm::vec4(0, 0, 1, 128 / 255.0F));
    EXPECT_EQ(found_.colours.corners[0], glm::uvec3(kNone));
  }
  EXPECT_NE(readBytes(path("out.glb")).find(R"("alphaMode":"BLEND","name":"a & b")"), std::string::npos);
}

TEST_F(MeshAttributesTest, OfA3mfStayInARepair) {
  // The tetrahedra cross, and the first one lacks a face.
  std::string bytes = coloured3mf(R"(pid="8" p1="0")", "1");
  Mesh mesh = loadText("in.3mf", bytes);
  mesh.triangles.erase(mesh.triangles.begin());
  ASSERT_EQ(found_.partOf.size(), 8u);
  found_.partOf.erase(found_.partOf.begin());
  found_.materialOf.erase(found_.materialOf.begin());
  found_.colours.corners.erase(found_.colours.corners.begin());
  const MeshAttributes given = found_;
  const Repaired repaired =
      repair(mesh, fitRepairGrid(mesh, {.voxelSize = 0.5}, {}), {}, {}, {.device = "cpu"});
  found_ = carryAttributes(given, mesh, repaired.mesh, repaired.faceSource);
  store("out.3mf", repaired.mesh);
  EXPECT_EQ(said_, "");
  const Mesh read = load(path("out.3mf"));
  ASSERT_EQ(read.triangles.size(), repaired.faceSource.size());
  size_t kept = 0;
  for (size_t f = 0; f < read.triangles.size(); ++f) {
    const uint32_t source = repaired.faceSource[f];
    // Most faces of the object are red, so those without a property are.
    EXPECT_EQ(found_.materialOf[f], source == kNone ? 0u : given.materialOf[source]) << f;
    kept += source == 6 ? 1 : 0;
    for (int c = 0; c < 3 && source == 6; ++c) EXPECT_EQ(colourAt(f, c), glm::vec4(0, 1, 0, 1));
  }
  EXPECT_GT(kept, 0u);
}

TEST_F(MeshAttributesTest, OfA3mfThatAreMalformedAreLeftOutOrRefused) {
  for (const char* last : {R"(pid="8" p1="2")", R"(pid="8" p1="0" p2="4294967295")", R"(pid="9" p1="0")"}) {
    loadText("in.3mf", coloured3mf(last, "9"));
    EXPECT_EQ(
        said_,
        "file_content in.3mf: materials or colours of 1 triangle have an unknown group or an index out of "
        "range, and are left out\n");
    EXPECT_EQ(found_.materialOf.at(7), kNone);
    EXPECT_EQ(found_.colours.corners.at(7), glm::uvec3(kNone));
  }
  EXPECT_EQ(codeOf([&] { loadText("in.3mf", coloured3mf(R"(p1="-1")", "9")); }), ErrorCode::Input);
  const std::string model =
      samples::model3mf(R"(<basematerials id="3"><base name="a" displaycolor="#12345G"/></basematerials>)" +
                            samples::square3mf(1),
                        {R"(objectid="1")"});
  EXPECT_EQ(codeOf([&] { loadText("in.3mf", samples::threeMf(model)); }), ErrorCode::Input);
}

/// Expects what the textured GLB has, whatever its vertices and triangles.
void expectTextured(const Mesh& mesh, const MeshAttributes& found) {
  EXPECT_EQ(found.materials, (std::vector<std::string>{"paint", "material 1"}));
  ASSERT_EQ(found.materialOf.size(), mesh.triangles.size());
  ASSERT_EQ(found.uvs.corners.size(), mesh.triangles.size());
  ASSERT_EQ(found.colours.corners.size(), mesh.triangles.size());
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    const glm::dvec3 a = mesh.position(t.x), b = mesh.position(t.y), c = mesh.position(t.z);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    // The second box is from 1 to 3 along each axis; the first one begins at 0.
    EXPECT_EQ(found.materialOf[f], std::max({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}) > 2.0 ? 1u : 0u);
    for (int k = 0; k < 3; ++k) {
      const glm::vec2 uv = found.uvs.values.at(found.uvs.corners[f][k]);
      EXPECT_LT(glm::distance(uv, samples::uvAt(mesh.position(t[k]), normal)), 1e-6F) << f << " " << k;
      if (found.materialOf[f] == 1) continue;
      const glm::vec4 colour = found.colours.values.at(found.colours.corners[f][k]);
      // 0.2 and 0.4 in sRGB.
      EXPECT_LT(glm::distance(colour, {0.484529F, 0.665185F, 0.0F, 1.0F}), 2e-6F) << f;
    }
  }
}

TEST_F(MeshAttributesTest, OfAGlbAreKeptAndWrittenAgain) {
  std::string buffer;
  const std::string json = samples::texturedJson(buffer);
  const Mesh mesh = loadText("in.glb", samples::glb(json, buffer));
  EXPECT_EQ(said_, "");
  EXPECT_EQ(found_.lost, (std::vector<std::string>{"1 texture with other coordinates"}));
  found_.lost.clear();
  expectTextured(mesh, found_);
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = 0.5}, {});
  const Repaired repaired = repair(mesh, grid, {}, {}, {.device = "cpu"});
  EXPECT_NEAR(repaired.report.after.signedVolume, 15.0, 1e-9);  // The boxes cut each other.
  const MeshAttributes given = found_;
  Mesh mirrored = loadText(
      "in.glb",
      samples::glb(samples::replaced(json, R"({"mesh":0})", R"({"mesh":0,"scale":[1,1,-1]})"), buffer));
  for (glm::vec3& v : mirrored.vertices) v.z = -v.z;
  mirrored.origin.z = -mirrored.origin.z;
  expectTextured(mirrored, found_);
  for (const Mesh& each : {mesh, repaired.mesh}) {
    found_ = each.triangles.size() == 24 ? given : carryAttributes(given, mesh, each, repaired.faceSource);
    store("out.glb", each);
    EXPECT_EQ(said_, "");
    const std::string text = readBytes(path("out.glb"));
    for (
        const char* kept :
        {R"("extensionsUsed":["KHR_texture_transform"])", R"("extensionsRequired":["KHR_texture_transform"])",
         R"({"name":"paint","pbrMetallicRoughness":{"baseColorTexture":{"extensions":{"KHR_texture_transform":)"
         R"({"scale":[2,3]}},"index":0}}},{"alphaCutoff":0.5,"alphaMode":"MASK"}])",
         R"("samplers":[{"wrapS":33071}])", R"("textures":[{"sampler":0,"source":0}])"})
      EXPECT_NE(text.find(kept), std::string::npos) << kept;
    EXPECT_EQ(text.find(samples::kImage) % 4, 0u);
    const Mesh read = load(path("out.glb"));
    expectTextured(read, found_);
    EXPECT_EQ(diagnose(read).boundaryEdges, 0u);
    EXPECT_EQ(said_, "");
    store("again.glb", read);
    EXPECT_EQ(readBytes(path("again.glb")), text);
  }
  found_ = given;
  store("out.obj", mesh);
  EXPECT_EQ(said_, "attributes_lost out.obj: it lacks what the given mesh has: looks of materials\n");
  expectTextured(load(path("out.obj")), found_);
}

TEST_F(MeshAttributesTest, ColoursOfAGlbAreLinear) {
  store("out.glb", loadText("in.obj", "v 0 0 0 0.25 0.5 1\nv 1 0 0 0 1 0.02\nv 0 1 0 1 1 1\nf 1 2 3\n"));
  const std::string bytes = readBytes(path("out.glb"));
  // Those of the sRGB standard: ((c + 0.055) / 1.055)^2.4, and c / 12.92 below 0.04045.
  for (const std::vector<float>& linear :
       {std::vector<float>{0.0508761F, 0.2140411F, 1.0F, 1.0F}, {0.0F, 1.0F, 0.00154799F, 1.0F}}) {
    bool isFound = false;
    for (size_t at = 0; at + 16 <= bytes.size(); at += 4) {
      float values[4];
      std::memcpy(values, bytes.data() + at, sizeof(values));
      isFound |= std::ranges::equal(values, linear, [](float a, float b) { return std::abs(a - b) < 1e-6F; });
    }
    EXPECT_TRUE(isFound) << linear[0];
  }
  load(path("out.glb"));
  EXPECT_LT(glm::distance(colourAt(0, 0), {0.25F, 0.5F, 1.0F, 1.0F}), 1e-6F);
  EXPECT_LT(glm::distance(colourAt(0, 1), {0.0F, 1.0F, 0.02F, 1.0F}), 1e-6F);
}

TEST_F(MeshAttributesTest, OfAnObjAreInAGlbToo) {
  const Mesh mesh = loadText("in.obj", kObj);
  store("out.glb", mesh);
  EXPECT_EQ(said_, "attributes_lost out.glb: it lacks what the given mesh has: looks of materials\n");
  const Mesh read = load(path("out.glb"));
  EXPECT_EQ(read.vertices.size(),
            mesh.vertices.size() + 2);  // Two have texture coordinates in one face alone.
  EXPECT_EQ(found_.materials, (std::vector<std::string>{"red paint", "blue"}));
  EXPECT_EQ(found_.materialOf, (std::vector<uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(uvAt(1, 1), glm::vec2(0.9F, 0.8F));
  EXPECT_EQ(partOf(2), "high/base");
  store("out.ply", read);
  EXPECT_EQ(said_,
            "attributes_lost out.ply: it lacks what the given mesh has: 2 part names and 2 materials; a .glb "
            "keeps them\n");
}

TEST_F(MeshAttributesTest, OfAGlbThatAreMalformedAreLeftOut) {
  std::string buffer;
  const std::string json = samples::texturedJson(buffer);
  const auto expectSaid = [&](const std::string& from, const std::string& to, const std::string& what,
                              const std::string& lost) {
    loadText("in.glb", samples::glb(samples::replaced(json, from, to), buffer));
    EXPECT_EQ(said_, "file_content in.glb: " + what + "; its " + lost + " are left out\n");
    EXPECT_EQ(std::ranges::count(found_.lost, lost), 1) << lost;
  };
  expectSaid(R"("material":1)", R"("material":2)", "materials[2] does not exist: the file has 2",
             "materials");
  EXPECT_TRUE(found_.materialOf.empty() && !found_.uvs.corners.empty());
  expectSaid(R"("TEXCOORD_0":4)", R"("TEXCOORD_0":3)", "accessors[3] should have type VEC2",
             "texture coordinates");
  EXPECT_TRUE(found_.uvs.corners.empty() && !found_.colours.corners.empty());
  expectSaid(R"("COLOR_0":6)", R"("COLOR_0":60)", "accessors[60] does not exist: the file has 7", "colours");
  expectSaid(R"("count":24,"type":"VEC4")", R"("count":23,"type":"VEC4")",
             "accessors[6]: COLOR_0 of 23 vertices, POSITION has 24", "colours");
  expectSaid(R"("bufferView":7,)", R"("bufferView":8,)", "bufferViews[8] does not exist: the file has 8",
             "looks of materials");
  EXPECT_EQ(found_.materials.size(), 2u);
  std::string many;
  for (int i = 0; i < 2000; ++i) many += R"({"bufferView":0},)";
  expectSaid(R"("images":[)", R"("images":[)" + many, "its images share most of their bytes",
             "looks of materials");
  const std::string deep = samples::replaced(json, R"("samplers":[)", R"("x":)" + std::string(300, '['));
  EXPECT_EQ(samples::errorOf(readGltf, deep), "sample.mesh: its JSON is nested too deep");
  buffer.replace(288, 4, "\xff\xff\xff\x7f");
  expectSaid("", "", "TEXCOORD_0 holds nan", "texture coordinates");
}

TEST_F(MeshAttributesTest, OfAGltfHaveTheirImagesEmbedded) {
  std::string buffer;
  const std::string json = samples::texturedJson(buffer), image = R"("bufferView":7,"mimeType":"image/png")";
  std::ofstream(path("a b.png")) << samples::kImage;
  for (const char* uri : {"a%20b.png", "data:image/png;base64,iVBORyBubyBwaXhlbHM=", "c.png", "../a b.png"}) {
    const Mesh mesh =
        loadText("in.glb",
                 samples::glb(samples::replaced(json, image, R"("uri":")" + std::string(uri) + '"'), buffer));
    store("out.glb", mesh);
    const std::string text = readBytes(path("out.glb"));
    const bool isKept = *uri != 'c' && *uri != '.';
    EXPECT_EQ(text.find(samples::kImage) != text.npos, isKept) << uri;
    EXPECT_EQ(text.find(uri) == text.npos, isKept);
  }
}

TEST_F(MeshAttributesTest, OfOtherFilesAreNamedAsLost) {
  loadText("in.off", "STCOFF\n3 1 0\n0 0 0 1 1 1 1 0 0\n1 0 0 1 1 1 1 0 0\n0 1 0 1 1 1 1 0 0\n3 0 1 2\n");
  EXPECT_EQ(found_.lost, (std::vector<std::string>{"colours", "texture coordinates"}));
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", stl = samples::binaryStl();
  const auto lostOf = [&](const std::string& name, const std::string& text) {
    loadText(name, text);
    return found_.lost.empty() ? std::string() : found_.lost.at(0);
  };
  EXPECT_EQ(lostOf("in.off", off + "\n"), "");
  EXPECT_EQ(lostOf("in.off", off + " 255 0 0\n"), "colours of faces");
  EXPECT_EQ(lostOf("in.off", off + " # red\n"), "");
  const std::string binary = samples::binaryOff();
  EXPECT_EQ(lostOf("in.off", binary), "");
  EXPECT_EQ(lostOf("in.off", binary.substr(0, binary.size() - 4) + samples::raw<int32_t>({1, 7}, true)),
            "colours of faces");
  EXPECT_EQ(lostOf("in.stl", stl), "");
  EXPECT_EQ(lostOf("in.stl", std::string(stl).replace(132, 2, samples::raw<uint16_t>(0x801f))),
            "attributes of facets, such as colours");
  const std::string facet =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  EXPECT_EQ(lostOf("in.stl", facet + "endsolid\n"), "");
  EXPECT_EQ(lostOf("in.stl", facet + "color 1 0 0\nendsolid\n"), "colours");
}

TEST_F(MeshAttributesTest, ThatDoNotFitTheMeshAreRefused) {
  const Mesh mesh = loadText("in.obj", kObj);
  const MeshAttributes right = found_;
  const auto code = [&] { return codeOf([&] { store("out.obj", mesh); }); };
  found_.partOf.pop_back();
  EXPECT_EQ(code(), ErrorCode::Usage);
  found_ = right;
  found_.materialOf[0] = 2;
  EXPECT_EQ(code(), ErrorCode::Usage);
  found_ = right;
  found_.uvs.corners[0].y = uint32_t(found_.uvs.values.size());
  EXPECT_EQ(code(), ErrorCode::Usage);
}

TEST_F(MeshAttributesTest, SurviveAnyChangeOfAFile) {
  std::mt19937 random(7);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 51 0 1\n1 0 0 0 255 0 1 1\n0 1 0 1 2 3 0 0\n3 0 1 2\n";
  const std::string bytes = "0123456789-/. \n\\vtfogxyzr";
  size_t readable = 0;
  for (int turn = 0; turn < 4000; ++turn) {
    const bool isObj = turn % 2 == 0;
    std::string text = isObj ? kObj : ply;
    for (int change = 0; change < 3; ++change) {
      const size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, 1 + random() % 4);
      else
        text[at] = bytes[random() % bytes.size()];
    }
    MeshAttributes attributes;
    MeshFile file{std::as_bytes(std::span(text)), path("in"), [](const Warning&) {}};
    file.attributes = &attributes;
    try {
      const Mesh mesh = isObj ? readObj(file) : readPly(file);
      ++readable;
      EXPECT_NO_THROW(writeMesh(path("out.obj"), mesh, {.attributes = &attributes})) << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()), "");
    }
  }
  EXPECT_GT(readable, 500u);
}

}  // namespace
}  // namespace raymap
