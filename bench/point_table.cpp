// Compares points that `Surface::query` answers with brute force in double precision, and prints a table in
// Markdown. `point_table [TESTS [FILE...]]`: TESTS limits the visits of triangles by each kind of points; the
// files are those of the shared folder if none is named.

#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "mesh_folder.h"
#include "program.h"
#include "reference.h"

namespace {

using namespace raymap;

constexpr size_t kMostPoints = 100000;

/// Returns the mesh as the surface takes it for signs.
Mesh turnedMesh(Mesh mesh, const Stats& stats) {
  for (const uint32_t f : stats.turnedFaces) std::swap(mesh.triangles[f].y, mesh.triangles[f].z);
  for (const uint32_t f : stats.leftOutFaces) mesh.triangles[f] = glm::uvec3(mesh.triangles[f].x);
  return mesh;
}

std::vector<glm::dvec3> uniformPoints(const Mesh& mesh, size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Box box = bounds(mesh);
  const double padding = 0.1 * std::max({box.size().x, box.size().y, box.size().z});
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = box.min[axis] - padding + unit(random) * (box.size()[axis] + 2.0 * padding);
  return points;
}

/// Returns points within 0.001 of the diagonal of the surface.
std::vector<glm::dvec3> nearPoints(const Mesh& mesh, size_t count) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double reach = 1e-3 * glm::length(bounds(mesh).size());
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) {
    const glm::uvec3& t = mesh.triangles[random() % mesh.triangles.size()];
    const double s = std::sqrt(unit(random)), r = unit(random);
    const double height = 2.0 * unit(random) - 1.0, angle = 6.283185307179586 * unit(random);
    const double flat = std::sqrt(1.0 - height * height), length = reach * unit(random);
    p = (1.0 - s) * mesh.position(t.x) + s * (1.0 - r) * mesh.position(t.y) + s * r * mesh.position(t.z) +
        length * glm::dvec3(flat * std::cos(angle), flat * std::sin(angle), height);
  }
  return points;
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
    const Errors near = compare(surface, mesh, turned, nearPoints(mesh, count));
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
