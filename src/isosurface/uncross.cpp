// Intersection-free contouring (Ju & Udeshi 2006), applied only where faces cross.

#include "isosurface/uncross.h"

#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <set>

#include "base/memory.h"

namespace raymap {

namespace {

// Rings of quads around suspects: quads that these may cross, and more in case those move.
constexpr int kRings = 3;
constexpr int kMostRounds = 16;
constexpr size_t kSearchBytes = 128;  // Memory per face to search for crossings, in bytes.

class Uncrosser {
 public:
  Uncrosser(const ContourCubes& cubes, const ContourSheets& sheets, const Grid& grid,
            std::vector<uint8_t>& isSuspect, Mesh& mesh)
      : cubes_(cubes),
        sheets_(sheets),
        spacing_(grid.spacing),
        middle_(0.5 * glm::dvec3(grid.dims - 1)),
        mesh_(mesh) {
    for (int ring = 0; ring < kRings; ++ring) grow(isSuspect);
    for (uint32_t quad = 0; quad < isSuspect.size(); ++quad)
      if (isSuspect[quad] != 0) searched_.insert(searched_.end(), {2 * quad, 2 * quad + 1});
  }

  void run(Progress& progress) {
    checkSurfaceMemory(kSearchBytes * searched_.size());
    isFan_.resize(cubes_.quadCount());
    for (int round = 0; round < kMostRounds; ++round) {
      progress.report(double(round) / kMostRounds);
      if (!mend(findCrossed())) return;
    }
  }

 private:
  /// Adds the quads that have a vertex in the same cubes as the chosen ones.
  void grow(std::vector<uint8_t>& chosen) const {
    std::vector<bool> isNear(cubes_.vertexCount());
    for (uint32_t quad = 0; quad < chosen.size(); ++quad)
      if (chosen[quad] != 0)
        for (const uint32_t vertex : cornersOf(quad)) {
          const ContourCube& cube = cubes_.ofVertex(vertex).cube;
          for (int sheet = 0; sheet < cube.cycles.count(); ++sheet)
            isNear[cube.firstVertex + uint32_t(sheet)] = true;
        }
    for (uint32_t quad = 0; quad < chosen.size(); ++quad)
      chosen[quad] =
          std::ranges::any_of(cornersOf(quad), [&](uint32_t vertex) { return isNear[vertex]; }) ? 1 : 0;
  }

  /// Returns the corners of a quad that is not a fan.
  std::array<uint32_t, 4> cornersOf(uint32_t quad) const {
    const glm::uvec3 &first = mesh_.triangles[2 * quad], &second = mesh_.triangles[2 * quad + 1];
    return {first.x, first.y, first.z, second.z};
  }

  std::vector<uint32_t> findCrossed() {
    Mesh part;
    for (const uint32_t face : searched_) part.triangles.push_back(mesh_.triangles[face]);
    part.vertices.swap(mesh_.vertices);
    std::vector<uint32_t> faces = findSelfIntersections(part).faces;
    part.vertices.swap(mesh_.vertices);
    for (uint32_t& face : faces) face = searched_[face];
    return faces;
  }

  /// Makes fans and levels vertices at the crossed faces. Returns whether anything changed.
  bool mend(const std::vector<uint32_t>& faces) {
    const size_t fans = fans_.size(), levelled = levelled_.size();
    const std::vector<bool> wasFan = isFan_;
    for (const uint32_t face : faces) {
      const uint32_t quad = quadOf(face);
      if (!isFan_[quad])
        fan(quad);
      else if (wasFan[quad])
        level(face);
    }
    return fans_.size() > fans || levelled_.size() > levelled;
  }

  uint32_t quadOf(uint32_t face) const {
    const size_t half = face / 2, quads = cubes_.quadCount();
    return half < quads ? uint32_t(half) : fans_[half - quads];
  }

  void fan(uint32_t quad) {
    const auto middle = uint32_t(mesh_.vertices.size());
    const std::array<uint32_t, 4> q = cornersOf(quad);
    mesh_.vertices.push_back(toMesh(sheets_.crossing(quad)));
    mesh_.triangles[2 * quad] = {q[0], q[1], middle};
    mesh_.triangles[2 * quad + 1] = {q[1], q[2], middle};
    for (const glm::uvec3& face : {glm::uvec3(q[2], q[3], middle), glm::uvec3(q[3], q[0], middle)}) {
      searched_.push_back(uint32_t(mesh_.triangles.size()));
      mesh_.triangles.push_back(face);
    }
    isFan_[quad] = true;
    fans_.push_back(quad);
  }

  /// Moves the vertices of the cubes at a fan's face to the means of their crossings.
  void level(uint32_t face) {
    for (const uint32_t vertex : {mesh_.triangles[face].x, mesh_.triangles[face].y}) {
      const auto [cube, place] = cubes_.ofVertex(vertex);
      if (!levelled_.insert(cube.firstVertex).second) continue;
      uint32_t moved = cube.firstVertex;
      for (const PlaneFit& sheet : sheets_.fit(cube, place)) mesh_.vertices[moved++] = toMesh(sheet.mean());
    }
  }

  glm::vec3 toMesh(const glm::dvec3& samples) const { return glm::vec3(spacing_ * (samples - middle_)); }

  const ContourCubes& cubes_;
  const ContourSheets& sheets_;
  double spacing_;
  glm::dvec3 middle_;
  Mesh& mesh_;
  std::vector<uint32_t> searched_;  // Faces that are searched for crossings.
  std::vector<bool> isFan_;         // One per quad.
  std::vector<uint32_t> fans_;      // Quads of the triangle pairs appended after those of all quads.
  std::set<uint32_t> levelled_;     // First vertices of the cubes that `level` has moved.
};

}  // namespace

void uncross(const ContourCubes& cubes, const ContourSheets& sheets, const Grid& grid,
             std::vector<uint8_t> isSuspect, Mesh& mesh, Progress& progress) {
  if (std::ranges::any_of(isSuspect, [](uint8_t is) { return is != 0; }))
    Uncrosser(cubes, sheets, grid, isSuspect, mesh).run(progress);
}

}  // namespace raymap
