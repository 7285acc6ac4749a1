// Every mesh of the folder whose MESHES.tsv holds the measurements of an independent tool; skipped without
// it.

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <sstream>

#include "mesh_folder.h"

namespace raymap {
namespace {

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

glm::dvec3 vector(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  return {std::stod(parts.at(0)), std::stod(parts.at(1)), std::stod(parts.at(2))};
}

double signedVolume(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    sum += glm::dot(a, glm::cross(b, c));
  }
  return sum / 6.0;
}

class MeshFiles : public testing::Test {
 protected:
  void SetUp() override {
    rows_ = meshRows();
    RAYMAP_NEED_MESHES();
  }
  std::vector<MeshRow> rows_;
};

TEST_F(MeshFiles, WholeOnesLoadAsMeasured) {
  for (MeshRow& row : rows_) {
    if (row["kind"] == "malformed") continue;
    SCOPED_TRACE(row["file"]);
    Mesh mesh;
    EXPECT_NO_THROW(mesh = readMesh(meshFolder() / row["file"]));
    if (mesh.triangles.empty()) continue;
    EXPECT_EQ(mesh.triangles.size(), std::stoull(row["triangles"]));
    EXPECT_NO_THROW(validate(mesh));

    // The table gives six digits.
    const Box box = bounds(mesh);
    const glm::dvec3 low = vector(row["bbox_min"]), size = vector(row["bbox_size"]);
    const double longest = std::max({size.x, size.y, size.z});
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(box.min[c], low[c], 1e-5 * (longest + std::abs(low[c])));
      EXPECT_NEAR(box.size()[c], size[c], 1e-5 * longest);
    }
    if (row["watertight"] == "yes" && row["consistently_oriented"] == "yes") {
      EXPECT_NEAR(signedVolume(mesh), std::stod(row["signed_volume"]), 1e-5 * longest * longest * longest);
    }
  }
}

TEST_F(MeshFiles, BrokenOnesAreRefusedByName) {
  for (MeshRow& row : rows_) {
    if (row["kind"] != "malformed") continue;
    SCOPED_TRACE(row["file"]);
    try {
      readMesh(meshFolder() / row["file"]);
      ADD_FAILURE() << "it was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input) << error.what();
      EXPECT_NE(std::string(error.what()).find(row["file"]), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace raymap
