#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <map>
#include <sstream>

#include "mesh_folder.h"

namespace raymap {
namespace {

/// Returns the comma-separated numbers of a cell, which the table rounds to six digits.
std::vector<double> numbers(const std::string& cell) {
  std::vector<double> values;
  std::istringstream in(cell);
  for (std::string value; std::getline(in, value, ',');) values.push_back(std::stod(value));
  return values;
}

std::map<std::string, std::string> asRow(const Diagnostics& found) {
  const auto yes = [](bool value) { return std::string(value ? "yes" : "no"); };
  return {{"triangles", std::to_string(found.triangles)},
          {"vertices_welded", std::to_string(found.weldedVertices)},
          {"watertight", yes(found.watertight)},
          {"consistently_oriented", yes(found.consistentlyOriented)},
          {"balanced", yes(found.balanced)},
          {"components", std::to_string(found.components)},
          {"boundary_edges", std::to_string(found.boundaryEdges)},
          {"nonmanifold_edges", std::to_string(found.nonManifoldEdges)},
          {"flipped_edges", std::to_string(found.flippedEdges)},
          {"duplicate_faces", std::to_string(found.duplicateFaces)}};
}

void expectNear(const glm::dvec3& value, const std::string& cell, double size) {
  const std::vector<double> expected = numbers(cell);
  ASSERT_EQ(expected.size(), 3u);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(value[a], expected[a], 6e-6 * std::abs(expected[a]) + 1e-7 * size);
}

void expectRow(const Diagnostics& found, const std::map<std::string, std::string>& row) {
  for (const auto& [column, value] : asRow(found)) EXPECT_EQ(value, row.at(column)) << column;
  // A height close to the limit may round to either side of it.
  const double degenerate = std::stod(row.at("degenerate_faces"));
  EXPECT_NEAR(double(found.degenerateFaces), degenerate, 0.01 * degenerate);
  const double size = glm::length(found.bounds.size());
  expectNear(found.bounds.min, row.at("bbox_min"), size);
  expectNear(found.bounds.size(), row.at("bbox_size"), size);
  // The volume of an almost flat mesh cancels beyond single precision.
  const double volume = numbers(row.at("signed_volume")).at(0);
  EXPECT_NEAR(found.signedVolume, volume, 6e-6 * std::abs(volume) + 1e-7 * size * found.area);
}

TEST(Diagnostics, AgreesWithTheTableOfRealMeshes) {
  const std::vector<MeshRow> table = meshRows();
  RAYMAP_NEED_MESHES();
  int compared = 0, closedGaps = 0;
  for (const auto& row : table) {
    SCOPED_TRACE(row.at("file"));
    if (row.at("kind") == "malformed") continue;
    Mesh mesh;
    try {
      mesh = readMesh(meshFolder() / row.at("file"));
    } catch (const Error&) {
      continue;  // tests/io/mesh_files_test.cpp says which must load.
    }
    const Diagnostics found = diagnose(mesh);
    // Every stage treats positions as one that single precision does not resolve (1e-16 apart in
    // trimesh__featuretype.STL), and so do the diagnostics.
    if (found.weldedVertices < std::stoul(row.at("vertices_welded"))) {
      ++closedGaps;
      continue;
    }
    expectRow(found, row);
    ++compared;
  }
  EXPECT_GT(compared, 60);
  EXPECT_LE(closedGaps, 5);
}

TEST(Diagnostics, CountsCrossingsAsExactArithmeticDoes) {
  RAYMAP_NEED_MESHES();
  const std::map<std::string, size_t> pairs{{"vtkdata__greatWhite.stl", 401},
                                            {"assimp__Wuson.stl", 494},
                                            {"prusa3__mgs-body.stl", 231},
                                            {"geogram__sphere_icosa_2.obj", 228},
                                            {"geogram__three_cubes.obj", 8}};
  for (const auto& [name, count] : pairs)
    EXPECT_EQ(findSelfIntersections(readMesh(meshFolder() / name)).pairs, count) << name;
}

}  // namespace
}  // namespace raymap
