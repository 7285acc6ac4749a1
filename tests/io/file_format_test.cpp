// Formats of files whose names do not tell them.

#include "io/file_format.h"
#include "error_code.h"

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <thread>

#include "files.h"
#include "fill.h"
#include "shapes.h"

namespace raymap {
namespace {

class FileFormat : public testing::Test {
 protected:
  std::string told(const std::string& bytes, const Formats& known) const {
    std::ofstream(path(), std::ios::binary) << bytes;
    return formatOf(SourceFile(path()), "", known);
  }
  std::filesystem::path path(const std::string& name = "unnamed.dat") const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_;
};

Formats meshesAndFields() {
  return {".obj", ".ply",  ".stl", ".off", ".gltf", ".glb", ".3mf", ".fbx",
          ".dae", ".nrrd", ".npy", ".npz", ".vti",  ".vdb", ".nvdb"};
}

std::string zipWith(const std::string& name) {
  std::string bytes("PK\x03\x04", 4);
  bytes.resize(30, '\0');
  bytes[26] = static_cast<char>(name.size());
  return bytes + name + "content";
}

std::string binaryStl(size_t triangles, size_t moreBytes) {
  std::string bytes(84 + 50 * triangles + moreBytes, 's');
  for (size_t i = 0; i < 4; ++i) bytes[80 + i] = i == 0 ? static_cast<char>(triangles) : '\0';
  return bytes;
}

TEST_F(FileFormat, IsToldByTheFirstBytes) {
  const std::vector<std::pair<std::string, std::string>> samples{
      {"ply\nformat", ".ply"},
      {"ply\r\nformat", ".ply"},
      {"plywood", ""},
      {"glTF\x02", ".glb"},
      {"NRRD0004\n", ".nrrd"},
      {"\x93NUMPY\x01", ".npy"},
      {" BDV", ".vdb"},
      {"NanoVDB0", ".nvdb"},
      {"NanoVDB2", ".nvdb"},
      {zipWith("distance.npy"), ".npz"},
      {zipWith("[Content_Types].xml"), ".3mf"},
      {zipWith("3D/3dmodel.model"), ".3mf"},
      {zipWith("_rels/.rels"), ".3mf"},
      {zipWith("readme.txt"), ""},
      {"PK\x03\x04", ""},
      {"Kaydara FBX Binary  ", ".fbx"},
      {"; FBX 7.3.0 project file", ".fbx"},
      {"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">", ".vti"},
      {"\xef\xbb\xbf<?xml version=\"1.0\"?><COLLADA>", ".dae"},
      {"<html>", ""},
      {"  {\n\"asset\": {}}", ".gltf"},
      {"Solid cube\n Facet normal 0 0 1", ".stl"},
      {"solid empty\nendsolid", ".stl"},
      {"solid ground", ""},
      {binaryStl(2, 0), ".stl"},
      {binaryStl(2, 1), ""},
      {"# a comment\n\n  v 0 0 0\n", ".obj"},
      {"mtllib a.mtl\n", ".obj"},
      {"vertex 0 0 0\n", ""},
      {"OFF\n8 6 0\n", ".off"},
      {"# from CGAL\nCOFF\n", ".off"},
      {"OFFICE\n", ""},
      {"off\n8 6 0\n", ".off"},
      {"4OFF\n", ".off"},
      {"\xef\xbb\xbfOFF\n", ".off"},
      {"\xef\xbb\xbfv 0 0 0\n", ".obj"},
      {"\xef\xbb\xbfply\nformat", ".ply"},
      {"\xef\xbb\xbfsolid\nendsolid", ".stl"},
      {"facet normal 0 0 1\nouter loop\nvertex 0 0 0", ".stl"},
      {"facet of a stone\n", ""},
      {"1 2 3\n", ""},
      {"", ""},
  };
  for (const auto& [bytes, format] : samples)
    EXPECT_EQ(told(bytes, meshesAndFields()), format) << bytes.substr(0, 40);
  const Formats points = pointExtensions();
  EXPECT_EQ(told("1,2,3\n", points), ".csv");
  EXPECT_EQ(told("x;y;z\n", points), ".csv");
  EXPECT_EQ(told("1\t2 3\n", points), ".xyz");
  EXPECT_EQ(told("1 2 3\n\x01", points), "");
  EXPECT_EQ(told("ply\n", points), ".ply");
  EXPECT_EQ(told("NRRD0004\n", {".npy"}), "");
}

TEST_F(FileFormat, NamesComeFirst) {
  std::ofstream(path("a.PLY")) << "NRRD0004\n";
  std::ofstream(path("a.dat")) << "NRRD0004\n";
  const Formats known = meshesAndFields();
  EXPECT_EQ(formatOf(SourceFile(path("a.PLY")), ".stl", known), ".ply");
  EXPECT_EQ(formatOf(SourceFile(path("a.dat")), ".stl", known), ".stl");
  EXPECT_EQ(formatOf(SourceFile(path("a.dat")), ".csv", known), ".nrrd");
  EXPECT_EQ(formatOf(std::filesystem::path("a.Stl"), ".ply", {".stl", ".ply"}), ".stl");
  EXPECT_EQ(formatOf(std::filesystem::path("a.txt"), ".ply", {".stl", ".ply"}), ".ply");
  EXPECT_EQ(formatOf(std::filesystem::path("a.txt"), "", {".stl", ".ply"}), ".txt");
  EXPECT_NE(messageOf(ErrorCode::File, [&] { formatOf(SourceFile(path("missing")), "", known); })
                .find("missing: no such file"),
            std::string::npos);
}

TEST_F(FileFormat, PipesAreReadAsFilesAre) {
  const Mesh torus = shapes::torus(2.0, 0.7, 40, 24);
  for (const std::string& format : writableMeshExtensions()) {
    SCOPED_TRACE(format);
    writeMesh(path("mesh" + format), torus);
    const Mesh expected = readMesh(path("mesh" + format));
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    std::thread writer([&] { writeMesh(path("pipe"), torus, {.format = format}); });
    const Mesh mesh = readMesh(path("pipe"));
    writer.join();
    std::filesystem::remove(path("pipe"));
    EXPECT_EQ(mesh.vertices, expected.vertices);
    EXPECT_EQ(mesh.triangles, expected.triangles);
    EXPECT_EQ(mesh.origin, expected.origin);
  }
}

TEST_F(FileFormat, RefusesOtherFilesAsWhatTheyAre) {
  const std::string png = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + std::string(200, '\0');
  const std::vector<std::pair<std::string, std::string>> samples{
      {"<!DOCTYPE html>\n<html><body>Not found</body></html>", "it is a web page; download the file itself"},
      {"\n<HTML>", "it is a web page; download the file itself"},
      {"\xef\xbb\xbf<?xml version=\"1.0\"?><a/>", "it is XML"},
      {"{\"error\": 404}", "it is JSON"},
      {zipWith("part.stl"), "it is a zip archive; unpack it"},
      {"\x1f\x8b\x08" + std::string(200, '\0'), "it is compressed with gzip; unpack it"},
      {png, "it is a PNG picture"},
      {"%PDF-1.4\n" + std::string(100, 'x'), "it is a PDF document"},
      {"ISO-10303-21;\nHEADER;", "it is a STEP file; export a mesh from it"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:",
       "it is a pointer of Git LFS; fetch the file itself"}};
  for (const char* extension : {".stl", ".obj", ".ply", ".off"})
    for (const auto& [bytes, what] : samples) {
      const std::string name = path(std::string("other") + extension).string();
      std::ofstream(name, std::ios::binary) << bytes;
      try {
        readMesh(name);
        ADD_FAILURE() << "read " << what << " as " << extension;
      } catch (const Error& error) {
        EXPECT_EQ(error.what(), name + ": " + what);
        EXPECT_EQ(error.code(), ErrorCode::Input);
      }
    }
  for (const auto& [name, bytes, what] :
       std::vector<std::array<std::string, 3>>{{"text.obj", "solid a\nfacet normal 0 0 1\nendsolid", ".stl"},
                                               {"ply.stl", "ply\nformat ascii 1.0\nend_header\n", ".ply"},
                                               {"obj.off", "v 0 0 0\nf 1 2 3\n", ".obj"},
                                               {"glb.ply", "glTF\x02", ".glb"},
                                               {"vdb.stl", " BDV" + std::string(100, '\1'), ".vdb"}}) {
    std::ofstream(path(name), std::ios::binary) << bytes;
    try {
      readMesh(path(name));
      ADD_FAILURE() << "read " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), path(name).string() + ": its bytes are those of a " + what + "; rename it");
    }
  }
  // Formats that begin so keep their own messages, and a header of a binary STL may say anything.
  std::ofstream(path("a.gltf")) << "{}";
  std::ofstream(path("a.3mf")) << zipWith("readme.txt");
  for (const char* name : {"a.gltf", "a.3mf"}) {
    try {
      readMesh(path(name));
      ADD_FAILURE() << "read " << name;
    } catch (const Error& error) {
      for (const char* other : {"it is a zip archive", "it is JSON"})
        EXPECT_EQ(std::string(error.what()).find(other), std::string::npos) << error.what();
    }
  }
  std::string stl = binaryStl(1, 0).replace(0, 6, "{html}");
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::memcpy(stl.data() + 96, corners, sizeof corners);
  std::ofstream(path("a.stl"), std::ios::binary) << stl;
  EXPECT_EQ(readMesh(path("a.stl")).triangles.size(), 1u);
}

TEST_F(FileFormat, TellsMeshesFromFields) {
  writeMesh(path("mesh"), shapes::torus(2.0, 0.7, 40, 24), {.format = ".stl"});
  EXPECT_TRUE(std::holds_alternative<Mesh>(read(path("mesh"))));
  Field field;
  field.grid = {{2, 3, 4}, {0.0, 0.0, 0.0}, 1.0};
  field.distance.resizeUninitialized(24);
  std::fill(field.distance.begin(), field.distance.end(), 1.0F);
  for (const std::string& format : fieldExtensions()) {
    writeField(path("field"), field, {.format = format});
    const auto found = read(path("field"));
    ASSERT_TRUE(std::holds_alternative<Field>(found)) << format;
    EXPECT_TRUE(std::ranges::equal(std::get<Field>(found).distance, field.distance)) << format;
  }
}

TEST_F(FileFormat, RefusesTheOtherKind) {
  writeMesh(path("mesh.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)));
  Field field;
  field.grid = {{2, 2, 2}, glm::dvec3(0.0), 1.0};
  fill(field.distance, std::vector(8, 1.0F));
  writeField(path("field.nrrd"), field);
  const auto messageOf = [](auto&& read) -> std::string {
    try {
      read();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(messageOf([&] { readMesh(path("field.nrrd")); }).find("it is a field, and a mesh is needed"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { readField(path("mesh.ply")); }).find("it is a mesh, and a field is needed"),
            std::string::npos);
}

}  // namespace
}  // namespace raymap
