// Compares points that `Surface::query` answers with brute force in double precision, and prints a table in
// Markdown. `point_table [TESTS [FILE...]]`: TESTS limits the visits of triangles by each kind of points; the
// files are those of the shared folder if none is named.

#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "program.h"
#include "testing/mesh_rows.h"
#include "testing/random_points.h"
#include "testing/reference.h"

namespace {

using namespace raymap;

constexpr size_t kMostPoints = 100000;
constexpr double kNear = 1e-3;  // of the diagonal

/// Returns the mesh as the surface takes it for signs.
Mesh turnedMesh(Mesh mesh, const Stats& stats) {
  for (const uint32_t f : stats.turnedFaces) std::swap(mesh.triangles[f].y, mesh.triangles[f].z);
  for (const uint32_t f : stats.leftOutFaces) mesh.triangles[f] = glm::uvec3(mesh.triangles[f].x);
  return mesh;
}

struct Errors {
  size_t points = 0, wrong = 0;
  double distance = 0.0;  // largest error, as a share of the diagonal
};

Errors compare(const Surface& surface, const Mesh& mesh, const Mesh& turned,
               const std::vector<glm::dvec3>& points) {
  const QueryResult result = surface.query(points, {.closest = true, .triangle = true, .barycentric = true});
  const double diagonal = glm::length(bounds(mesh).size());
  std::vector<double> errors(points.size());
  std::vector<uint8_t> isWrong(points.size());
  parallelFor(points.size(), 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double distance = std::abs(result.distance[i]), exact = reference::distance(mesh, points[i]);
      const glm::uvec3& t = mesh.triangles[result.triangle[i]];
      const glm::dvec3 weights = result.barycentric[i];
      const glm::dvec3 closest =
          weights.x * mesh.position(t.x) + weights.y * mesh.position(t.y) + weights.z * mesh.position(t.z);
      errors[i] = std::max({std::abs(distance - exact), glm::distance(closest, result.closest[i]),
                            std::abs(glm::distance(closest, points[i]) - exact)}) /
                  diagonal;
      const double winding = std::abs(reference::windingNumber(turned, points[i]));
      isWrong[i] = exact > 0.0 && (winding > 0.5) != std::signbit(result.distance[i]);
    }
  });
  return {points.size(), size_t(std::count(isWrong.begin(), isWrong.end(), 1)),
          *std::max_element(errors.begin(), errors.end())};
}

int run(int argc, char** argv) {
  const double tests = argc > 1 ? std::atof(argv[1]) : 1e8;
  std::vector<std::string> names(argv + std::min(argc, 2), argv + argc);
  if (names.empty())
    for (const std::string& name : wellFormedMeshes()) names.push_back((meshFolder() / name).string());
  std::printf(
      "| mesh | triangles | all rays agree | points | wrong: anywhere | near | largest error of the distance "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const Mesh mesh = readMesh(name);
    const size_t count =
        std::min(kMostPoints, static_cast<size_t>(tests / static_cast<double>(mesh.triangles.size())));
    if (count < 100) continue;
    const Surface surface(mesh);
    const Mesh turned = turnedMesh(mesh, surface.stats());
    const Errors anywhere = compare(surface, mesh, turned, uniformPoints(mesh, count));
    const Errors near = compare(surface, mesh, turned, nearPoints(mesh, count, kNear));
    std::printf("| %s | %zu | %s | %zu | %zu | %zu | %.1e |\n",
                std::filesystem::path(name).filename().string().c_str(), mesh.triangles.size(),
                surface.stats().misfit == 0.0 && surface.stats().doubtfulShare == 0.0 ? "yes" : "no", count,
                anywhere.wrong, near.wrong, std::max(anywhere.distance, near.distance));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return raymap::bench::runProgram("point_table", run, argc, argv);
}
