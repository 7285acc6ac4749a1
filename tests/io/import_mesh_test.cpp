#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include <cstdlib>
#include <functional>
#include <thread>

#include "files.h"
#include "import_samples.h"
#include "io/import/import_stream.h"
#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::contains;
using samples::isSquare;
using samples::replaced;
using samples::TemporaryFile;

Mesh readAs(const std::string& extension, const std::string& bytes) {
  const TemporaryFile file("import" + extension, bytes);
  return readMesh(file.path());
}

std::string errorAs(const std::string& extension, const std::string& bytes) {
  try {
    readAs(extension, bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(ImportMesh, ReadsEachFormat) {
  EXPECT_TRUE(isSquare(readAs(".dae", samples::dae())));
  EXPECT_TRUE(isSquare(readAs(".fbx", samples::fbx())));
  EXPECT_TRUE(isSquare(readAs(".DAE", samples::dae())));
}

/// Returns the coordinates of the corners of the U.
std::string numbersOfU(const std::string& separator) {
  std::string numbers;
  for (const glm::ivec2& p : samples::kU)
    numbers += (numbers.empty() ? "" : separator) + std::to_string(p.x) + separator + std::to_string(p.y) +
               separator + "0";
  return numbers;
}

TEST(ImportMesh, CutsConcavePolygons) {
  for (const char* node : {"", "<scale>-1 1 1</scale>"}) {
    std::string dae = samples::dae(std::string("<node>") + node + R"(<instance_geometry url="#g"/></node>)");
    dae = replaced(replaced(dae, R"(count="12")", R"(count="24")"), R"(count="4")", R"(count="8")");
    dae = replaced(replaced(dae, "0 0 0 1 0 0 1 1 0 0 1 0", numbersOfU(" ")), "<vcount>4", "<vcount>8");
    for (const size_t first : {0, 1}) {
      const Mesh mesh = readAs(".dae", replaced(dae, "0 1 2 3<", samples::faceOfU(first, false) + "<"));
      EXPECT_TRUE(samples::isU(mesh)) << first;
      EXPECT_EQ(samples::areaVector(mesh), glm::dvec3(0, 0, 7)) << "mirrored or not";
    }
  }
  std::string fbx = replaced(replaced(samples::fbx(), "*12", "*24"), "*4", "*8");
  fbx = replaced(replaced(fbx, "0,0,0,1,0,0,1,1,0,0,1,0", numbersOfU(",")), "0,1,2,-4", "1,2,3,4,5,6,7,-1");
  EXPECT_TRUE(samples::isU(readAs(".fbx", fbx)));
}

TEST(ImportMesh, WarnsOfWhatItCannotCut) {
  const TemporaryFile file("import.dae", replaced(samples::dae(), "0 1 2 3<", "0 2 1 3<"));
  std::string warnings;
  readMesh(file.path(), {.warn = [&](const Warning& warning) { warnings += warning.message + "\n"; }});
  EXPECT_EQ(warnings,
            file.path().string() +
                ": 1 face crosses itself, or its corners lie on a line: its triangles may overlap\n");
}

TEST(ImportMesh, AppliesNodesAndInstancesOfDae) {
  const Mesh mesh = readAs(
      ".dae",
      samples::dae(
          R"(<node><translate>0 0 5</translate><node><scale>-1 3 1</scale><instance_geometry url="#g"/>)"
          R"(</node></node><node><instance_geometry url="#g"/></node>)"));
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(bounds(mesh).min, glm::dvec3(-1, 0, 0));
  EXPECT_EQ(bounds(mesh).max, glm::dvec3(1, 3, 5));
  EXPECT_EQ(samples::areaVector(mesh), glm::dvec3(0, 0, 4)) << "the mirrored instance faces the same way";
}

TEST(ImportMesh, ReadsAttributes) {
  const TemporaryFile file("attributes.dae", samples::attributedDae());
  MeshAttributes found;
  std::string said;
  const auto warn = [&](const Warning& warning) { said += warning.message + "\n"; };
  const Mesh mesh = readMesh(file.path(), {.warn = warn, .attributes = &found});
  EXPECT_EQ(mesh.triangles, readMesh(file.path()).triangles);
  ASSERT_EQ(mesh.triangles.size(), 6u);
  EXPECT_EQ(found.parts, (std::vector<MeshPart>{{"left"}, {"right"}}));
  EXPECT_EQ(found.materials, (std::vector<std::string>{"red paint", "glass"}));
  const uint32_t none = MeshAttributes::kNone;
  EXPECT_EQ(found.partOf, (std::vector<uint32_t>{0, 0, 1, 1, none, none}));
  // Assimp gives the third one a material that it does not have.
  EXPECT_TRUE(std::equal(found.materialOf.begin(), found.materialOf.begin() + 4, found.partOf.begin()));
  const std::vector<glm::vec2> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 0.25}};
  const std::vector<glm::vec4> colours{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {0.5, 0.25, 1, 1}};
  for (size_t f = 0; f < 6; ++f)
    for (int c = 0; c < 3; ++c) {
      const uint32_t uv = found.uvs.corners[f][c], colour = found.colours.corners[f][c];
      EXPECT_EQ(uv == none, f >= 4);
      EXPECT_EQ(colour == none, f >= 4);
      if (f >= 4) continue;
      const glm::dvec3 p = mesh.position(mesh.triangles[f][c]);
      const size_t corner = p.y == 0.0 ? size_t(p.x) : size_t(3.0 - p.x);
      EXPECT_EQ(found.uvs.values[uv], uvs[corner]);
      EXPECT_EQ(found.colours.values[colour], colours[corner]);
    }
  EXPECT_EQ(found.lost.size(), 0u);
  EXPECT_EQ(said, "");
  const TemporaryFile obj("out.obj", ""), package("out.3mf", ""), scene("out.glb", "");
  writeMesh(obj.path(), mesh, {.warn = warn, .attributes = &found});
  EXPECT_NE(readBytes(obj.path()).find("o right\nusemtl glass\nf 5/5 6/6 7/7\n"), std::string::npos);
  EXPECT_EQ(said, obj.path().string() + ": it lacks what the given mesh has: looks of materials\n");
  said = {};
  writeMesh(scene.path(), mesh, {.warn = warn, .attributes = &found});
  EXPECT_EQ(said, "");
  // The linear value of one half, and the alpha of the glass.
  const std::string glb = readBytes(scene.path());
  for (const char* kept :
       {R"("name":"red paint")", R"("baseColorFactor":[1.0,0.21404114)", R"([0.0,0.0,1.0,0.25])"})
    EXPECT_NE(glb.find(kept), std::string::npos) << kept;
  writeMesh(package.path(), mesh, {.warn = warn, .attributes = &found});
  EXPECT_EQ(said, package.path().string() +
                      ": it lacks what the given mesh has: texture coordinates and materials of 4 coloured "
                      "triangles; an .obj keeps texture coordinates\n");
}

TEST(ImportMesh, SaysWhatOfAnFbxIsLost) {
  MeshAttributes found;
  readMesh(std::filesystem::path(RAYMAP_TEST_DATA) / "scene.fbx", {.attributes = &found});
  EXPECT_EQ(found.parts, (std::vector<MeshPart>{{"Again"}, {"Box"}, {"Wedge"}}));
  EXPECT_EQ(found.materials.size(), 0u);
  EXPECT_EQ(found.lost.size(), 0u);
  std::string textured = samples::attributedDae();
  textured = replaced(textured, "<color>1 0.5 0 1</color>", R"(<texture texture="s" texcoord="u"/>)");
  textured = replaced(textured, R"(<input semantic="COLOR" source="#hc" offset="2"/>)",
                      R"(<input semantic="TEXCOORD" source="#ht" offset="1" set="1"/>)"
                      R"(<input semantic="COLOR" source="#hc" offset="2"/>)"
                      R"(<input semantic="COLOR" source="#hc" offset="2" set="1"/>)");
  const TemporaryFile file("textured.dae", textured);
  readMesh(file.path(), {.attributes = &found});
  EXPECT_EQ(found.lost,
            (std::vector<std::string>{"1 texture", "further texture coordinates", "further colours"}));
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LT(glm::distance(a, b), 1e-4 * glm::length(b)) << a.x << ' ' << a.y << ' ' << a.z;
}

// Blender wrote one scene to both formats (data/make_scene.py): a node, its child, and a mirrored instance.
TEST(ImportMesh, ReadsBinaryFbxInItsOwnUnitsAndAxes) {
  const std::filesystem::path folder = RAYMAP_TEST_DATA;
  const Diagnostics fbx = diagnose(readMesh(folder / "scene.fbx")),
                    glb = diagnose(readMesh(folder / "scene.glb"));
  for (const Diagnostics& scene : {fbx, glb}) {
    EXPECT_EQ(scene.triangles, 28u);
    EXPECT_EQ(scene.components, 3u);
    EXPECT_TRUE(scene.watertight && scene.consistentlyOriented);
  }
  EXPECT_NEAR(glb.signedVolume, 5.375, 1e-4);  // Metres, y up.
  expectNear(glb.bounds.min, {-4, 0, -5.232051});
  expectNear(glb.bounds.max, {3.598076, 4.555351, -1});
  EXPECT_NEAR(fbx.signedVolume, 5.375e6, 1e2);  // Centimetres, z up.
  expectNear(fbx.bounds.min, {-400, 100, 0});
  expectNear(fbx.bounds.max, {359.8076, 523.2051, 455.5351});
}

TEST(ImportMesh, PassesOnTheImportersMessages) {
  EXPECT_TRUE(contains(errorAs(".dae", "<COLLADA"), "import.dae: "));
  EXPECT_TRUE(
      contains(errorAs(".fbx", std::string("Kaydara FBX Binary  \0\x1a\0\x4c\x1d\0\0\xff\xff\xff\xff", 31)),
               "import.fbx: "));
}

TEST(ImportMesh, NamesNumbersThatNoFileOfItsSizeHas) {
  const std::string whole = samples::dae();
  const auto error = [&](const std::string& from, const std::string& to) {
    const std::string text = errorAs(".dae", samples::replaced(whole, from, to));
    return text.substr(text.find(": ") + 2);
  };
  const std::string many = "4000000000";
  for (const char* element : {"<float_array", "<polylist"}) {
    const size_t at = whole.find("count=\"", whole.find(element));
    ASSERT_NE(at, whole.npos) << element;
    const size_t end = whole.find('"', at + 7);
    const std::string damaged = whole.substr(0, at + 7) + many + whole.substr(end);
    const std::string text = errorAs(".dae", damaged);
    const auto line =
        std::to_string(1 + std::count(damaged.begin(), damaged.begin() + static_cast<long>(at), '\n'));
    EXPECT_TRUE(contains(text, ": line " + line + ": 'count' is 4000000000, but the whole file has " +
                                   std::to_string(damaged.size()) + " bytes"))
        << text;
  }
  EXPECT_TRUE(contains(error("<vcount>4", "<vcount>" + many), "a number of <vcount> is 4000000000"));
}

TEST(ImportMesh, CanBeUsedByManyThreads) {
  const TemporaryFile file("threads.dae", samples::dae());
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back([&] { EXPECT_TRUE(isSquare(readMesh(file.path()))); });
  for (std::thread& thread : threads) thread.join();
}

/// Replaces the importer by a program.
class InPlaceOfTheImporter {
 public:
  explicit InPlaceOfTheImporter(const std::string& script)
      : file_("importer", "#!/bin/sh\n" + script + "\n") {
    std::filesystem::permissions(file_.path(), std::filesystem::perms::owner_all);
    setenv("RAYMAP_IMPORT", file_.path().c_str(), 1);
  }
  ~InPlaceOfTheImporter() { unsetenv("RAYMAP_IMPORT"); }

 private:
  TemporaryFile file_;
};

/// A stream of the importer: two triangles with attributes.
struct Sent {
  MeshHeader header{.vertices = 4, .triangles = 2, .runs = 2, .parts = 1, .materials = 1, .nameBytes = 5};
  std::vector<MeshRun> runs{{1, 0, MeshRun::kNone, 1, 0}, {1, MeshRun::kNone, 0, 0, 1}};
  std::string names{"a\0bc\0", 5};
  std::vector<glm::vec4> materials{{1, 1, 0, 1}}, colours = std::vector<glm::vec4>(4, {0, 0, 1, 1});
  std::vector<glm::vec2> uvs = std::vector<glm::vec2>(4, {0, 1});

  Sent() { header.hasUvs = header.hasColours = 1; }

  std::string bytes() const {
    const ImportHeader first;
    std::string all;
    const auto add = [&](const void* data, size_t size) { all.append(static_cast<const char*>(data), size); };
    const auto addAll = [&](const auto& values) { add(values.data(), values.size() * sizeof(values[0])); };
    add(&first, sizeof(first));
    add(&header, sizeof(header));
    addAll(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    addAll(std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}});
    addAll(runs);
    addAll(names);
    addAll(materials);
    addAll(uvs);
    addAll(colours);
    return all;
  }
};

TEST(ImportMesh, RefusesAttributesThatDoNotFit) {
  MeshAttributes found;
  std::string said;
  const auto receive = [&](const std::string& bytes) -> std::string {
    const TemporaryFile stream("stream", bytes), file("import.dae", "");
    const InPlaceOfTheImporter sender("cat '" + stream.path().string() + "'");
    found = {}, said = {};
    try {
      const auto warn = [&](const Warning& warning) { said += warning.message + "\n"; };
      EXPECT_EQ(readMesh(file.path(), {.warn = warn, .attributes = &found}).triangles.size(), 2u);
    } catch (const Error& error) {
      return std::string(error.what()).substr(file.path().string().size());
    }
    return {};
  };
  const auto receiveWith = [&](const std::function<void(Sent&)>& change) {
    Sent sent;
    change(sent);
    return receive(sent.bytes());
  };
  EXPECT_EQ(receiveWith([](Sent&) {}), "");
  EXPECT_EQ(found.parts, (std::vector<MeshPart>{{"a"}}));
  EXPECT_EQ(found.materials, (std::vector<std::string>{"bc"}));
  const uint32_t none = MeshAttributes::kNone;
  EXPECT_EQ(found.partOf, (std::vector<uint32_t>{0, none}));
  EXPECT_EQ(found.materialOf, (std::vector<uint32_t>{none, 0}));
  EXPECT_EQ(found.uvs.corners, (std::vector<glm::uvec3>{{0, 1, 2}, glm::uvec3(none)}));
  EXPECT_EQ(found.colours.corners, (std::vector<glm::uvec3>{glm::uvec3(none), {0, 2, 3}}));
  const std::vector<std::function<void(Sent&)>> faults{
      [](Sent& s) { s.runs[0].part = 1; },
      [](Sent& s) { s.runs[1].material = 1; },
      [](Sent& s) { s.runs[1].triangles = 0; },
      [](Sent& s) { s.runs[1].triangles = 2; },
      [](Sent& s) { s.runs[1].triangles = UINT64_MAX; },
      [](Sent& s) { s.names[4] = 'd'; },
      [](Sent& s) { s.names[2] = '\0'; },
      [](Sent& s) { s.names[1] = 'x'; },
  };
  for (size_t f = 0; f < faults.size(); ++f)
    EXPECT_EQ(receiveWith(faults[f]), ": its attributes do not fit its triangles") << f;
  for (uint64_t MeshHeader::*count :
       {&MeshHeader::runs, &MeshHeader::parts, &MeshHeader::materials, &MeshHeader::nameBytes})
    EXPECT_TRUE(contains(receiveWith([&](Sent& s) { s.header.*count = uint64_t{1} << 60; }),
                         "more than 2^32 parts, materials or bytes of their names"));
  const std::string whole = Sent().bytes();
  for (size_t size = whole.size() - 1; size > sizeof(ImportHeader) + sizeof(MeshHeader); size -= 7)
    EXPECT_NE(receive(whole.substr(0, size)), "") << size;
  EXPECT_EQ(receiveWith([](Sent& s) { s.uvs[2].y = NAN; }), "");
  EXPECT_TRUE(contains(said, ": its texture coordinates are not all finite numbers, and are left out"));
  EXPECT_TRUE(found.uvs.corners.empty() && !found.colours.corners.empty());
  EXPECT_EQ(receiveWith([](Sent& s) { s.names = std::string("\0bcd\0", 5); }), "");
  EXPECT_EQ(found.parts, (std::vector<MeshPart>{{""}}));
  EXPECT_EQ(receiveWith([](Sent& s) { s.names = std::string("a\0\0", 3), s.header.nameBytes = 3; }), "");
  EXPECT_EQ(found.materials, (std::vector<std::string>{"material 0"}));
}

TEST(ImportMesh, SurvivesWhateverTheImporterDoes) {
  {
    const InPlaceOfTheImporter crash("kill -SEGV $$");
    EXPECT_TRUE(
        contains(errorAs(".dae", ""), "import.dae: cannot read it: the importer crashed on it (Segm"));
  }
  {
    const InPlaceOfTheImporter stall("ulimit -t 1; while :; do :; done");
    EXPECT_TRUE(contains(errorAs(".dae", ""), "it took too long"));
  }
  {
    const InPlaceOfTheImporter silence("exit 3");
    EXPECT_TRUE(contains(errorAs(".dae", ""), "the importer ended with code 3"));
  }
  {
    const InPlaceOfTheImporter babble("printf 'this is no header at all, but long enough'");
    EXPECT_TRUE(contains(errorAs(".dae", ""), "speaks another version"));
  }
  {
    // A header that announces 2^56 vertices.
    const InPlaceOfTheImporter liar(
        R"(printf 'RMI9\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\001\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0' && head -c 72 /dev/zero)");
    EXPECT_TRUE(contains(errorAs(".dae", ""), "more than 2^32 triangles or vertices"));
  }
  setenv("RAYMAP_IMPORT", "/nonexistent/importer", 1);
  EXPECT_TRUE(contains(errorAs(".dae", ""), "cannot start /nonexistent/importer"));
  unsetenv("RAYMAP_IMPORT");
}

}  // namespace
}  // namespace raymap
