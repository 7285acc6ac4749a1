// Measures how well holes are closed (src/cpu/sign/close_holes.cpp) and prints a table in Markdown. A plane
// cuts a cap off a shape; its share of the area is that of a cap of 5, 15 or 30 degrees on a sphere.
//
//   close_holes_table [BUNNY [RESOLUTION]]: a closed mesh of the Stanford bunny

#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "testing/shapes.h"
#ifdef RAYMAP_BENCH_OPENVDB
#include "methods.h"
#endif

namespace raymap {
namespace {

/// Cuts off everything above the plane dot(normal, p) = offset.
struct Cut {
  glm::dvec3 normal;
  double offset;
};

struct Holed {
  Mesh open;    ///< The part below the plane.
  Mesh closed;  ///< The same with a lid in the plane.
  Mesh whole;   ///< The mesh before the cut.
};

class Cutter {
 public:
  Cutter(const Mesh& mesh, const Cut& cut) : cut_(cut) {
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v) positions_.push_back(mesh.position(v));
    for (const glm::uvec3& t : mesh.triangles) clip(t);
  }

  Holed result(const Mesh& whole) const {
    Holed holed{.open = makeMesh(positions_, triangles_), .closed = {}, .whole = whole};
    std::vector<glm::dvec3> positions = positions_;
    std::vector<glm::uvec3> triangles = triangles_;
    std::map<uint32_t, uint32_t> rest(rim_.begin(), rim_.end());
    while (!rest.empty()) {
      std::vector<uint32_t> loop{rest.begin()->first};
      for (auto next = rest.begin(); next != rest.end(); next = rest.find(loop.back())) {
        loop.push_back(next->second);
        rest.erase(next);
      }
      glm::dvec3 centre(0.0);
      for (size_t v = 1; v < loop.size(); ++v) centre += positions_[loop[v]] / double(loop.size() - 1);
      positions.push_back(centre);
      for (size_t v = 1; v < loop.size(); ++v)
        triangles.emplace_back(loop[v], loop[v - 1], uint32_t(positions.size() - 1));
    }
    holed.closed = makeMesh(positions, triangles);
    return holed;
  }

 private:
  double height(uint32_t v) const { return glm::dot(cut_.normal, positions_[v]) - cut_.offset; }

  /// Returns the vertex where the edge meets the plane, the same for both of its triangles.
  uint32_t middle(uint32_t a, uint32_t b) {
    const auto [it, isNew] = middles_.try_emplace(std::minmax(a, b), uint32_t(positions_.size()));
    const auto [low, high] = it->first;
    if (isNew)
      positions_.push_back(
          glm::mix(positions_[low], positions_[high], height(low) / (height(low) - height(high))));
    return it->second;
  }

  void clip(const glm::uvec3& t) {
    std::vector<uint32_t> kept;
    uint32_t leaves = 0, enters = 0;
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = t[c], b = t[(c + 1) % 3];
      if (height(a) <= 0.0) kept.push_back(a);
      if ((height(a) <= 0.0) == (height(b) <= 0.0)) continue;
      kept.push_back(middle(a, b));
      (height(a) <= 0.0 ? leaves : enters) = kept.back();
    }
    for (size_t c = 2; c < kept.size(); ++c) triangles_.emplace_back(kept[0], kept[c - 1], kept[c]);
    if (kept.size() > 2 && leaves != enters) rim_.emplace_back(leaves, enters);
  }

  Cut cut_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles_;
  std::vector<std::pair<uint32_t, uint32_t>> rim_;
};

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x);
    sum += 0.5 * glm::length(glm::cross(mesh.position(t.y) - a, mesh.position(t.z) - a));
  }
  return sum;
}

/// Cuts a share of the area off along the normal.
Holed cutOff(const Mesh& mesh, const glm::dvec3& normal, double degrees) {
  const double share = 0.5 * (1.0 - std::cos(degrees * std::numbers::pi / 180.0)), all = area(mesh);
  double low = INFINITY, high = -INFINITY;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    low = std::min(low, glm::dot(normal, mesh.position(v)));
    high = std::max(high, glm::dot(normal, mesh.position(v)));
  }
  for (int i = 0; i < 16; ++i) {
    const double offset = 0.5 * (low + high);
    (area(Cutter(mesh, {normal, offset}).result(mesh).open) < (1.0 - share) * all ? low : high) = offset;
  }
  return Cutter(mesh, {normal, low}).result(mesh);
}

/// Largest distance to compare, in samples: OpenVDB would take minutes to fill the box.
constexpr double kBand = 24.0;

/// Mean and largest error in samples.
double errorsOf(const Field& field, const Field& truth, double& largest) {
  double sum = 0.0;
  largest = 0.0;
  for (size_t s = 0; s < truth.distance.size(); ++s) {
    const auto samples = [&](float d) { return std::clamp(d / truth.grid.spacing, -kBand, kBand); };
    const double error = std::abs(samples(field.distance[s]) - samples(truth.distance[s]));
    sum += error;
    largest = std::max(largest, error);
  }
  return sum / double(truth.distance.size());
}

/// Returns the mean of abs(length(gradient) - 1) by central differences, over the samples within two spacings
/// of the lid.
double slopeError(const Field& field, const Buffer<float>& toLid) {
  const Grid& grid = field.grid;
  double sum = 0.0;
  size_t count = 0;
  for (int k = 1; k + 1 < grid.dims.z; ++k)
    for (int j = 1; j + 1 < grid.dims.y; ++j)
      for (int i = 1; i + 1 < grid.dims.x; ++i) {
        if (toLid[grid.index({i, j, k})] > 2.0 * grid.spacing) continue;
        glm::dvec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 before(i, j, k), after(i, j, k);
          --before[axis], ++after[axis];
          gradient[axis] =
              (field.distance[grid.index(after)] - field.distance[grid.index(before)]) / (2.0 * grid.spacing);
        }
        sum += std::abs(glm::length(gradient) - 1.0);
        ++count;
      }
  return sum / double(std::max<size_t>(count, 1));
}

/// Returns the volume inside the zero level. Each sample's cell counts by the share that a plane at this
/// distance would leave.
double volume(const Field& field) {
  double sum = 0.0;
  for (const float d : field.distance) sum += std::clamp(0.5 - d / field.grid.spacing, 0.0, 1.0);
  return sum * std::pow(field.grid.spacing, 3);
}

const MachineOptions kCpu{.device = "cpu"};

Mesh lidOf(const Holed& holed) {
  Mesh lid = holed.closed;
  lid.triangles.erase(lid.triangles.begin(),
                      lid.triangles.begin() + std::ptrdiff_t(holed.open.triangles.size()));
  return lid;
}

void printRow(const std::string& name, const char* method, const Field& field, const Holed& holed) {
  const Field toLid = generate(holed.closed, field.grid, {}, kCpu).field,
              toWhole = generate(holed.whole, field.grid, {}, kCpu).field;
  const Field lid = generate(lidOf(holed), field.grid, {.sign = SignMode::None}, kCpu).field;
  double largestToLid = 0.0, largestToWhole = 0.0;
  const double meanToLid = errorsOf(field, toLid, largestToLid),
               meanToWhole = errorsOf(field, toWhole, largestToWhole);
  const double enclosed = volume(field), ofLid = volume(toLid), ofWhole = volume(toWhole);
  std::printf("| %s | %s | %.3f | %.5f | %.3f | %.5f | %.4f | %+.4f %% | %+.4f %% |\n", name.c_str(), method,
              largestToLid, meanToLid, largestToWhole, meanToWhole, slopeError(field, lid.distance),
              100.0 * (enclosed / ofLid - 1.0), 100.0 * (enclosed / ofWhole - 1.0));
}

void printRows(const std::string& name, const Mesh& mesh, const glm::dvec3& normal, int resolution) {
  const Grid grid = fitGrid(mesh, {.resolution = resolution});
  for (const double degrees : {5.0, 15.0, 30.0}) {
    const Holed holed = cutOff(mesh, normal, degrees);
    const std::string row = name + ", " + std::to_string(int(degrees)) + "°";
    const Field plain = generate(holed.open, grid, {}, kCpu).field;
    const FieldOptions closing{.closeHoles = true};
    printRow(row, "`--close-holes`", generate(holed.open, grid, closing, kCpu).field, holed);
    printRow(row, "plain", plain, holed);
#ifdef RAYMAP_BENCH_OPENVDB
    Field vdb = generate(holed.open, grid, closing, kCpu).field;
    bench::runOpenvdb({.mesh = holed.open, .grid = grid, .band = kBand}, vdb.distance);
    printRow(row, "OpenVDB", vdb, holed);
#endif
  }
}

}  // namespace
}  // namespace raymap

int main(int argc, char** argv) {
  using namespace raymap;
  const int resolution = argc > 2 ? std::atoi(argv[2]) : 96;
  try {
    std::printf(
        "| shape, cap | method | max | mean | max to the uncut | mean to the uncut | slope | volume | "
        "volume to the uncut |\n|---|---|---|---|---|---|---|---|---|\n");
    printRows("sphere", shapes::sphere(1.0, 6), glm::normalize(glm::dvec3(0.2, 0.3, 0.9)), resolution);
    printRows("torus", shapes::torus(1.0, 0.4, 200, 100), glm::normalize(glm::dvec3(1.0, 0.1, 0.2)),
              resolution);
    if (argc > 1)
      printRows("bunny", readMesh(argv[1]), glm::normalize(glm::dvec3(1.0, 0.4, 0.0)), resolution);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
