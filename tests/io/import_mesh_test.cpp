#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include <cstdlib>
#include <thread>

#include "import_samples.h"
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
        R"(printf 'RMI8\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\001\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0' && head -c 32 /dev/zero)");
    EXPECT_TRUE(contains(errorAs(".dae", ""), "more than 2^32 triangles or vertices"));
  }
  setenv("RAYMAP_IMPORT", "/nonexistent/importer", 1);
  EXPECT_TRUE(contains(errorAs(".dae", ""), "cannot start /nonexistent/importer"));
  unsetenv("RAYMAP_IMPORT");
}

}  // namespace
}  // namespace raymap
