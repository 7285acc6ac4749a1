// Simplifies a closed mesh, measures the result, and undoes what is too far off or crosses.

#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/simplify.h>

#include <algorithm>
#include <cmath>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/require.h"
#include "cpu/points/close_distances.h"
#include "mesh/compact.h"
#include "mesh/disjoint_sets.h"
#include "mesh/face_points.h"
#include "mesh/part_volumes.h"
#include "simplify/decimate.h"

namespace raymap {

namespace {

// Share of the tolerance that collapses use: measured distances are rounded.
constexpr double kUsed = 0.99;
constexpr double kPointDistance = 10.0;  // In tolerances.
constexpr size_t kBytesPerFace = 300;
constexpr int kMostRepeats = 20;  // Most rounds of removing vertices again after some are back.

/// Signed volumes of the closed parts of a mesh. Thin parts can turn inside out.
class PartVolumes {
 public:
  explicit PartVolumes(const PackedMesh& mesh) : vertices_(mesh.vertices), sets_(mesh.vertices.size()) {
    parallelFor(mesh.triangles.size(), kCheapGrain, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) {
        sets_.link(mesh.triangles[f].x, mesh.triangles[f].y);
        sets_.link(mesh.triangles[f].x, mesh.triangles[f].z);
      }
    });
    given_ = measure(mesh.triangles, partsOf(mesh.triangles));
  }

  /// Returns the indices of the faces whose part has not the sign of volume that it had.
  std::vector<uint32_t> findTurned(std::span<const glm::uvec3> faces) {
    const std::vector<uint32_t> parts = partsOf(faces);
    const std::vector<double> volumes = measure(faces, parts);
    std::vector<uint32_t> turned;
    for (uint32_t f = 0; f < faces.size(); ++f)
      if (volumes[parts[f]] * given_[parts[f]] <= 0.0) turned.push_back(f);
    return turned;
  }

 private:
  /// Returns the part of each face: its lowest vertex.
  std::vector<uint32_t> partsOf(std::span<const glm::uvec3> faces) {
    std::vector<uint32_t> parts;
    parts.reserve(faces.size());
    for (const glm::uvec3& t : faces) parts.push_back(sets_.root(t.x));
    return parts;
  }

  std::vector<double> measure(std::span<const glm::uvec3> faces, std::span<const uint32_t> parts) const {
    return partVolumes({vertices_, faces, glm::dvec3(0.0)}, parts, vertices_.size());
  }

  std::span<const glm::vec3> vertices_;
  DisjointSets sets_;
  std::vector<double> given_;
};

class Simplifier {
 public:
  Simplifier(const PackedMesh& given, double tolerance, double step)
      : given_(given),
        tolerance_(tolerance),
        step_(step),
        decimator_(given, {.tolerance = kUsed * tolerance, .step = step}),
        toGiven_(given, 2.0 * tolerance),
        volumes_(given),
        measured_(given.triangles.begin(), given.triangles.end()),
        deviation_(given.triangles.size()) {}

  void run(Progress& progress, Simplified& result) {
    progress.part(0.0, 0.6);
    decimator_.run(progress);
    progress.part(0.6, 1.0);
    for (int round = 0;; ++round) {
      progress.report(1.0 - std::pow(0.5, round));
      const std::vector<uint32_t> wrong = findWrong();
      if (!decimator_.undoAt(wrong)) break;
      result.undone += wrong.size();
      if (round < kMostRepeats) decimator_.runAgain();
    }
    write(result);
  }

 private:
  /// Returns the faces at which a check fails.
  std::vector<uint32_t> findWrong() {
    collectFaces();
    std::vector<uint32_t> wrong = findFar();
    const PackedMesh mesh(given_.vertices, triangles_, given_.origin);
    for (const uint32_t k : findSelfIntersections(mesh).faces) wrong.push_back(faces_[k]);
    for (const uint32_t k : volumes_.findTurned(triangles_)) wrong.push_back(faces_[k]);
    return wrong;
  }

  void collectFaces() {
    faces_.clear();
    triangles_.clear();
    const CollapsibleMesh& mesh = decimator_.mesh();
    for (uint32_t f = 0; f < mesh.faceCount(); ++f)
      if (mesh.hasFace(f)) {
        faces_.push_back(f);
        triangles_.push_back(mesh.face(f));
      }
  }

  /// Returns the faces with a point too far from the given mesh, of those that changed since the last time.
  std::vector<uint32_t> findFar() {
    std::vector<uint32_t> changed;
    for (const uint32_t f : faces_)
      if (decimator_.mesh().face(f) != measured_[f]) changed.push_back(f);
    std::vector<glm::dvec3> points;
    std::vector<uint32_t> faces;
    const auto add = [&](uint32_t face, const glm::dvec3& p) {
      points.push_back(p);
      faces.push_back(face);
    };
    for (const uint32_t f : changed) {
      deviation_[f] = 0.0;
      forEachPoint(f, [&](const glm::dvec3& p) { add(f, p); });
    }
    for (const uint32_t f : changed) measured_[f] = decimator_.mesh().face(f);
    const Buffer<double> distances = toGiven_.measure(points).distance;
    for (size_t i = 0; i < points.size(); ++i)
      deviation_[faces[i]] = std::max(deviation_[faces[i]], distances[i]);
    std::vector<uint32_t> far;
    std::ranges::copy_if(faces_, std::back_inserter(far),
                         [&](uint32_t f) { return deviation_[f] > tolerance_; });
    return far;
  }

  /// Visits points of a face that changed: more on its edges, where it may be farthest off. Of two such
  /// faces, only one has those of their edge.
  template <class Visit>
  void forEachPoint(uint32_t f, Visit&& visit) const {
    const CollapsibleMesh& mesh = decimator_.mesh();
    const glm::uvec3 face = mesh.face(f);
    const glm::dvec3 a = given_.position(face.x), b = given_.position(face.y), c = given_.position(face.z);
    forEachFacePoint(a, b, c, step_, visit);
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const uint32_t other = mesh.twin(h) / 3;
      if (other < f && mesh.face(other) != measured_[other]) continue;
      const glm::dvec3 from = given_.position(mesh.from(h)), to = given_.position(mesh.to(h));
      forEachEdgePoint(from, to, partsOf(Decimator::kEdgePoints * glm::distance(from, to), step_), visit);
    }
  }

  /// Returns the largest distance from points of the given mesh to the result.
  double measureGiven(const PackedMesh& mesh) const {
    std::vector<glm::dvec3> points;
    for (uint32_t i = 0; i < decimator_.points().size(); ++i)
      if (i >= given_.vertices.size() || !decimator_.mesh().hasVertex(i))
        points.push_back(given_.origin + glm::dvec3(decimator_.points()[i]));
    const Buffer<double> distances = cpu::CloseDistances(mesh, 2.0 * tolerance_).measure(points).distance;
    return points.empty() ? 0.0 : *std::max_element(distances.begin(), distances.end());
  }

  void write(Simplified& result) {
    const PackedMesh mesh(given_.vertices, triangles_, given_.origin);
    result.deviation = measureGiven(mesh);
    for (const uint32_t f : faces_) result.deviation = std::max(result.deviation, deviation_[f]);
    result.mesh = {{given_.vertices.begin(), given_.vertices.end()}, triangles_, given_.origin};
    removeUnusedVertices(result.mesh);
  }

  PackedMesh given_;
  double tolerance_, step_;
  Decimator decimator_;
  cpu::CloseDistances toGiven_;
  PartVolumes volumes_;
  std::vector<glm::uvec3> measured_;   // Corners of each face when its deviation was measured.
  std::vector<double> deviation_;      // Deviation of each face from the given mesh.
  std::vector<uint32_t> faces_;        // Faces that are left,
  std::vector<glm::uvec3> triangles_;  // and their corners.
};

/// Returns whether all promises hold. Else the given mesh is kept.
bool isGood(const Simplified& result, double tolerance, int threads) {
  const Diagnostics found = diagnose(result.mesh, {.brief = true}, {.threads = threads});
  return found.watertight && found.consistentlyOriented && result.deviation <= tolerance;
}

}  // namespace

Simplified simplify(const MeshView& view, const SimplifyOptions& options, const MachineOptions& machine) {
  require(options.tolerance >= 0.0 && std::isfinite(options.tolerance), "the tolerance must not be negative");
  require(options.step >= 0.0 && std::isfinite(options.step), "the step must not be negative");
  validate(view);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  Simplified result;
  if (options.tolerance > 0.0 && !mesh.triangles.empty()) {
    checkSurfaceMemory(kBytesPerFace * mesh.triangles.size());
    const double step = options.step > 0.0 ? options.step : kPointDistance * options.tolerance;
    Progress progress(machine.progress);
    progress.stage("simplify", [&] {
      withThreads(machine.threads, [&] { Simplifier(mesh, options.tolerance, step).run(progress, result); });
    });
    if (isGood(result, options.tolerance, machine.threads)) return result;
    result = {};
  }
  result.mesh = {{mesh.vertices.begin(), mesh.vertices.end()},
                 {mesh.triangles.begin(), mesh.triangles.end()},
                 mesh.origin};
  return result;
}

}  // namespace raymap
