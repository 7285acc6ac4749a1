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
#include "base/text.h"
#include "cpu/points/close_distances.h"
#include "mesh/compact.h"
#include "mesh/disjoint_sets.h"
#include "mesh/face_points.h"
#include "mesh/model.h"
#include "mesh/part_volumes.h"
#include "mesh/triangle.h"
#include "simplify/decimate.h"

namespace raymap {

namespace {

// Share of the tolerance that collapses use: measured distances are rounded.
constexpr double kUsed = 0.99;
constexpr double kPointDistance = 10.0;  // In tolerances.
constexpr size_t kBytesPerFace = 300;
constexpr int kMostRepeats = 20;  // Most rounds of removing vertices again after some are back.
// A search for a tolerance aims at a share of the triangles that are allowed, and ends with a slightly
// smaller one, after some tries, or when tolerances of this ratio leave too many and few enough triangles.
constexpr double kAim = 0.98, kEnough = 0.96, kNarrow = 1.01;
constexpr int kMostTries = 8;
// Factors by which the tolerance may change until two tries enclose what is searched for.
constexpr double kLeastFactor = 1.5, kMostFactor = 16.0;
// Distance between points that are measured, as a share of the mean edge of so many triangles. It is at least
// the mean edge of the mesh: faces grow no larger than the area that their points cover.
constexpr double kEdgeShare = 0.25;
// Most such distances along the sides of a face, in the mean. Needles a million times as long as they are
// wide have a small area and would else have a million points each.
constexpr double kMostOnSides = 1000.0;

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
    result.tolerance = tolerance_;
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
bool isGood(const Simplified& result, int threads) {
  const Diagnostics found = diagnose(result.mesh, {.brief = true}, {.threads = threads});
  return found.watertight && found.consistentlyOriented && result.deviation <= result.tolerance;
}

Simplified kept(const PackedMesh& mesh) {
  return {.mesh = {{mesh.vertices.begin(), mesh.vertices.end()},
                   {mesh.triangles.begin(), mesh.triangles.end()},
                   mesh.origin}};
}

Simplified simplifyWithin(const PackedMesh& mesh, double tolerance, double step, Progress& progress) {
  Simplified result;
  Simplifier(mesh, tolerance, boundedStep(mesh, step)).run(progress, result);
  return result;
}

/// Searches for the least tolerance that leaves at most a number of triangles.
class ToleranceSearch {
 public:
  ToleranceSearch(const PackedMesh& mesh, const SimplifyOptions& options)
      : mesh_(mesh),
        options_(options),
        aim_(std::max(kAim * double(options.triangles), 1.0)),
        most_(options.tolerance),
        step_(options.step) {
    const glm::dvec3 size = bounds(mesh).size();
    const double longest = std::max({size.x, size.y, size.z});
    const auto [area, sides] = sumFaces(mesh);
    if (most_ == 0.0) most_ = longest;
    const double finest = std::min(aim_ / (kEdgeShare * kEdgeShare), double(mesh.triangles.size()));
    if (step_ == 0.0)
      step_ = std::max(std::sqrt(4.0 / std::sqrt(3.0) * area / finest),
                       sides / (kMostOnSides * double(mesh.triangles.size())));
    // Roughly right for a ball: half the tolerance leaves twice as many triangles.
    tolerance_ = std::min(area / (aim_ * longest), most_);
  }

  /// Returns the result of the best try.
  Simplified run(Progress& progress) {
    double done = 0.0;
    for (int tries = 0; tries < kMostTries; ++tries) {
      const double share = 0.4 * (1.0 - done);
      Progress part([&](std::string_view, double of) { return progress.report(done + share * of), true; });
      Simplified result = simplifyWithin(mesh_, tolerance_, step_, part);
      done += share;
      if (!add(std::move(result))) break;
    }
    return std::move(best_);
  }

 private:
  struct Try {
    double tolerance = 0.0, count = 0.0;
  };

  /// Chooses the next tolerance. Returns false if there is none that is worth a try.
  bool add(Simplified&& result) {
    const auto most = double(options_.triangles);
    const Try tried{result.tolerance, double(result.mesh.triangles.size())};
    const bool isFew = tried.count <= most;
    (isFew ? few_ : many_) = tried;
    if (isBetter(result)) best_ = std::move(result);
    if (isFew ? tried.count >= kEnough * most : tried.tolerance == most_) return false;
    if (few_.tolerance == 0.0)
      tolerance_ *= std::clamp(tried.count / aim_, kLeastFactor, kMostFactor);
    else if (many_.tolerance == 0.0)
      tolerance_ *= std::clamp(tried.count / aim_, 1.0 / kMostFactor, 1.0 / kLeastFactor);
    else
      tolerance_ = between();
    tolerance_ = std::min(tolerance_, most_);
    return few_.tolerance == 0.0 || few_.tolerance > kNarrow * many_.tolerance;
  }

  /// Returns whether a result is better than the best one: few enough triangles, then the less tolerance.
  bool isBetter(const Simplified& result) const {
    const size_t count = result.mesh.triangles.size(), best = best_.mesh.triangles.size();
    const bool isFew = count <= options_.triangles, isBestFew = best > 0 && best <= options_.triangles;
    if (best == 0 || isFew != isBestFew) return best == 0 || isFew;
    return isFew ? result.tolerance < best_.tolerance : count < best;
  }

  /// Returns a tolerance between two that gave too many and few enough triangles, on a power law.
  double between() const {
    const double share = std::log(many_.count / aim_) / std::log(many_.count / few_.count);
    return many_.tolerance * std::pow(few_.tolerance / many_.tolerance, std::clamp(share, 0.1, 0.9));
  }

  PackedMesh mesh_;
  SimplifyOptions options_;
  double aim_, most_, step_, tolerance_;
  Try many_, few_;  ///< The last tries with too many and with few enough triangles.
  Simplified best_;
};

void warnOfTriangles(size_t count, const SimplifyOptions& options, const WarningCallback& warn) {
  if (!warn || options.triangles == 0 || count <= options.triangles) return;
  warn({WarningCode::TrianglesMissed,
        std::to_string(count) + " triangles are left instead of " + std::to_string(options.triangles) +
            (options.tolerance > 0.0 ? ": no fewer were found within the tolerance of " +
                                           numberText(options.tolerance) + "; a larger one may leave fewer"
                                     : ": the mesh has too many parts, handles or details for fewer"),
        {.count = count}});
}

Simplified simplifyPacked(const PackedMesh& mesh, const SimplifyOptions& options,
                          const MachineOptions& machine) {
  Progress progress(machine.progress);
  Simplified result;
  const double step = options.step > 0.0 ? options.step : kPointDistance * options.tolerance;
  progress.stage("simplify", [&] {
    withThreads(machine.threads, [&] {
      result = options.triangles > 0 ? ToleranceSearch(mesh, options).run(progress)
                                     : simplifyWithin(mesh, options.tolerance, step, progress);
    });
  });
  return isGood(result, machine.threads) ? std::move(result) : kept(mesh);
}

}  // namespace

Simplified simplify(const MeshView& view, const SimplifyOptions& options, const MachineOptions& machine) {
  require(options.tolerance >= 0.0 && std::isfinite(options.tolerance), "the tolerance must not be negative");
  require(options.step >= 0.0 && std::isfinite(options.step), "the step must not be negative");
  validate(view);
  const Model mesh(view);
  const bool isWanted =
      options.triangles > 0 ? mesh.triangles.size() > options.triangles : options.tolerance > 0.0;
  if (!isWanted || mesh.triangles.empty()) return kept(mesh);
  checkSurfaceMemory(kBytesPerFace * mesh.triangles.size());
  Simplified result;
  try {
    result = simplifyPacked(mesh, options, machine);
  } catch (const Error& error) {
    const Mesh welded = weldedCopy(mesh);
    if (error.code() != ErrorCode::Input || welded.vertices.size() == mesh.vertices.size()) throw;
    result = simplifyPacked(welded, options, machine);
  }
  warnOfTriangles(result.mesh.triangles.size(), options, machine.warn);
  return result;
}

}  // namespace raymap
