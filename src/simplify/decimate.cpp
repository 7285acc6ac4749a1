// Edge collapses in the order of quadric errors (Garland & Heckbert 1997), each one checked.

#include "simplify/decimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "mesh/face_points.h"
#include "mesh/triangle.h"
#include "simplify/face_shape.h"

namespace raymap {

namespace {

constexpr size_t kPerTask = size_t{1} << 14;
constexpr double kTileSteps = 48.0;  // Size of a tile, in steps.
// Each pass may collapse edges of four times the cost of the one before. The last one takes any.
constexpr int kPasses = 5;
// Sweeps of a pass over all vertices. One that removes fewer than one vertex in so many is the last.
constexpr int kMostSweeps = 3;
constexpr size_t kWorthwhile = 20;
// Largest mean square of the distances to planes, divided by the tolerance's square. Points decide below it.
constexpr double kMostError = 16.0;
// Cost of an edge as long as a step, in the same unit. It makes the faces of planes grow evenly.
constexpr double kLength = 1e-3;
constexpr double kMinShape = 3e-4;       // Least height of a face, as a share of its longest edge.
constexpr double kMinCosOfChange = 0.3;  // Between a face's normals before and after a collapse.
constexpr double kMinCosOfAll = 0.8;     // Between a face's normals at first and now.
// A face with few points covers space where the given mesh has no surface. It may have an area, in squares of
// a step, of half a square, of two for each point, and of this for each step of its longest edge.
constexpr double kPerPoint = 2.0, kPerEdge = 0.1, kAlways = 0.5;
// New edges are measured if a point is farther from the new faces than this share of the tolerance.
constexpr double kNear = 0.4;

/// A point, and the face that it goes to.
struct PlacedPoint {
  uint32_t point, face;
};

}  // namespace

/// Faces around a vertex after a collapse.
struct Decimator::NewFaces {
  std::array<FaceShape, CollapsibleMesh::kMostValence> shapes;
  std::array<uint32_t, CollapsibleMesh::kMostValence> faces;
  std::array<double, CollapsibleMesh::kMostValence>
      bare;  // Area that is not covered by points yet, in steps.
  uint32_t count = 0;
};

/// Vertices that one thread may remove, and its memory.
struct Decimator::Task {
  std::vector<uint32_t> vertices;
  uint32_t record = 0;
  std::vector<PlacedPoint> placed = {};
  double farthest = 0.0;  // Square of the largest distance from a placed point to its face.
};

Decimator::Decimator(const PackedMesh& mesh, const DecimateOptions& options)
    : vertices_(mesh.vertices),
      options_(options),
      limit_(options.tolerance * options.tolerance),
      mesh_(mesh),
      given_(mesh, limit_),
      points_(mesh, mesh_, options.step, options.tolerance),
      normals_(mesh.triangles.size()),
      quadrics_(mesh.vertices.size()),
      wake_(mesh.vertices.size()),
      tile_(mesh.vertices.size()),
      isFree_(mesh.vertices.size()),
      isKept_(mesh.vertices.size()) {
  addPlanes();
}

void Decimator::addPlanes() {
  parallelFor(normals_.size(), kPerTask, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const glm::uvec3 face = mesh_.face(uint32_t(f));
      normals_[f] = glm::vec3(unitNormal(at(face.x), at(face.y), at(face.z)));
    }
  });
  parallelFor(quadrics_.size(), kPerTask, [&](size_t begin, size_t end) {
    Ring ring;
    for (auto v = uint32_t(begin); v < end; ++v) {
      if (!mesh_.hasVertex(v) || !mesh_.findRing(v, ring)) continue;
      for (const uint32_t h : ring.edges()) {
        const double twiceArea = glm::length(doubleAreaNormal(at(v), at(mesh_.to(h)), at(mesh_.opposite(h))));
        quadrics_[v].addPlane(glm::dvec3(normals_[h / 3]), at(v), twiceArea);
      }
    }
  });
}

void Decimator::run(Progress& progress) {
  progress.part(0.0, 0.4);
  runTiles(0.0, progress);
  progress.part(0.4, 0.7);
  runTiles(0.5, progress);
  progress.poll();
  std::ranges::fill(wake_, 0.0f);
  runAgain();
}

bool Decimator::isSurroundedByTile(uint32_t v) const {
  Ring ring;
  return mesh_.findRing(v, ring) &&
         std::ranges::all_of(ring.edges(), [&](uint32_t h) { return tile_[mesh_.to(h)] == tile_[v]; });
}

void Decimator::runTiles(double shift, Progress& progress) {
  constexpr uint32_t kTileBits = 10;
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& v : vertices_) {
    low = glm::min(low, glm::dvec3(v));
    high = glm::max(high, glm::dvec3(v));
  }
  const glm::dvec3 extent = high - low;
  const double size = std::max(kTileSteps * options_.step,
                               std::max({extent.x, extent.y, extent.z}) / (1 << kTileBits) * 1.01);
  std::vector<std::pair<uint32_t, uint32_t>> order;
  for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
    const glm::uvec3 tile((at(v) - low) / size + shift);
    tile_[v] = tile.x | tile.y << kTileBits | tile.z << 2 * kTileBits;
  }
  parallelFor(mesh_.vertexCount(), kPerTask, [&](size_t begin, size_t end) {
    for (auto v = uint32_t(begin); v < end; ++v)
      isFree_[v] = mesh_.hasVertex(v) && isSurroundedByTile(v) ? 1 : 0;
  });
  for (uint32_t v = 0; v < mesh_.vertexCount(); ++v)
    if (isFree_[v] != 0) {
      order.emplace_back(tile_[v], v);
      wake_[v] = 0.0f;
    }
  std::ranges::sort(order);
  std::vector<Task> tasks;
  for (size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) tasks.emplace_back();
    tasks.back().vertices.push_back(order[k].second);
  }
  const uint32_t record = mesh_.addRecords(tasks.size());
  WorkMeter meter(progress, 0.0, 1.0, double(order.size()) + 1.0);
  parallelFor(tasks.size(), 1, [&](size_t k, size_t) {
    tasks[k].record = record + uint32_t(k);
    const size_t count = tasks[k].vertices.size();
    reduce(tasks[k]);
    meter.add(count);
  });
}

void Decimator::runAgain() {
  Task task;
  task.record = mesh_.addRecords(1);
  for (uint32_t v = 0; v < mesh_.vertexCount(); ++v)
    if (mesh_.hasVertex(v)) isFree_[v] = 1, task.vertices.push_back(v);
  reduce(task);
}

void Decimator::reduce(Task& task) {
  for (int pass = 1; pass <= kPasses; ++pass) {
    const double most = pass < kPasses ? std::pow(0.25, kPasses - pass) : INFINITY;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      const size_t before = task.vertices.size();
      std::erase_if(task.vertices, [&](uint32_t v) {
        return !mesh_.hasVertex(v) || (double(wake_[v]) <= most && removeVertex(v, most, task));
      });
      if ((before - task.vertices.size()) * kWorthwhile <= before) break;
    }
  }
}

/// Tries the collapses of a vertex that cost at most `most`, the cheapest first.
bool Decimator::removeVertex(uint32_t v, double most, Task& task) {
  struct Target {
    double cost;
    uint32_t k;
  };
  std::array<Target, CollapsibleMesh::kMostValence> targets;
  uint32_t count = 0;
  const double tried = double(wake_[v]);  // Cheaper collapses have failed, and would again.
  wake_[v] = INFINITY;
  Ring ring;
  if (isKept_[v] != 0 || !mesh_.findRing(v, ring)) return false;
  float wake = INFINITY;
  for (uint32_t k = 0; k < ring.count; ++k) {
    const uint32_t end = mesh_.to(ring.all[k]);
    const double error = isFree_[end] != 0 ? quadrics_[v].meanSquare(at(end)) / limit_ : INFINITY;
    if (error > kMostError) continue;
    const double cost = error + kLength * squareOf((at(end) - at(v)) / options_.step);
    if (cost > most)
      wake = std::min(wake, static_cast<float>(cost));
    else if (cost >= tried * (1.0 - 1e-6))
      targets[count++] = {cost, k};
  }
  std::sort(targets.begin(), targets.begin() + count,
            [](const Target& a, const Target& b) { return std::pair(a.cost, a.k) < std::pair(b.cost, b.k); });
  for (uint32_t i = 0; i < count; ++i)
    if (collapse(v, ring, targets[i].k, task)) return true;
  wake_[v] = wake;
  return false;
}

bool Decimator::collapse(uint32_t v, const Ring& ring, uint32_t k, Task& task) {
  const uint32_t end = mesh_.to(ring.all[k]);
  Ring other;
  NewFaces faces;
  if (!mesh_.findRing(end, other) || !mesh_.canCollapse(ring, other) || !makeFaces(v, ring, k, faces) ||
      !placePoints(v, ring, faces, task))
    return false;
  if (task.farthest > kNear * kNear * limit_ && !staysNear(ring, k)) return false;
  for (const uint32_t h : ring.edges()) wake_[mesh_.to(h)] = 0.0f;
  quadrics_[end].add(quadrics_[v]);
  mesh_.collapse(ring, k, task.record);
  for (const uint32_t h : ring.edges()) points_.clear(h / 3);
  for (const auto& [point, face] : task.placed) points_.put(point, face);
  return true;
}

/// Returns false if a face would turn too far or get too thin.
bool Decimator::makeFaces(uint32_t v, const Ring& ring, uint32_t k, NewFaces& faces) const {
  struct Shape {
    glm::dvec3 b, c, across;
    double length, longest;
  };
  std::array<Shape, CollapsibleMesh::kMostValence> shapes;
  const uint32_t edge = ring.all[k], dropped = mesh_.twin(edge) / 3;
  const glm::dvec3 from = at(v), to = at(mesh_.to(edge));
  for (const uint32_t h : ring.edges()) {
    if (h == edge || h / 3 == dropped) continue;
    const glm::dvec3 b = at(mesh_.to(h)), c = at(mesh_.opposite(h));
    const glm::dvec3 before = doubleAreaNormal(from, b, c), after = doubleAreaNormal(to, b, c);
    const double length = glm::length(after);
    const double longest = std::max({squareOf(b - to), squareOf(c - to), squareOf(c - b)});
    if (!(length > kMinShape * longest) ||
        !(glm::dot(glm::dvec3(normals_[h / 3]), after) >= kMinCosOfAll * length) ||
        !(glm::dot(before, after) >= kMinCosOfChange * length * glm::length(before)))
      return false;
    shapes[faces.count] = {b, c, after, length, longest};
    faces.faces[faces.count++] = h / 3;
  }
  for (uint32_t i = 0; i < faces.count; ++i) {
    const auto& [b, c, across, length, longest] = shapes[i];
    const double steps = std::sqrt(longest) / options_.step;
    faces.shapes[i] = FaceShape(to, b, c, across / length);
    faces.bare[i] = 0.5 * length / (options_.step * options_.step) - kPerEdge * steps - kAlways;
  }
  return true;
}

/// Finds new faces for all points at a vertex and its faces. Returns false if a point has none within the
/// tolerance, or a face has too few points.
bool Decimator::placePoints(uint32_t v, const Ring& ring, NewFaces& faces, Task& task) const {
  task.placed.clear();
  task.farthest = 0.0;
  const auto place = [&](uint32_t point) {
    const glm::dvec3 p(points_.points()[point]);
    uint32_t found = 0;
    double least = limit_;
    while (found < faces.count && !faces.shapes[found].isBeside(p, limit_)) ++found;
    if (found < faces.count)
      least = faces.shapes[found].squaredHeight(p);
    else
      for (uint32_t i = 0; i < faces.count; ++i)
        if (const double squared = faces.shapes[i].squaredDistance(p); squared <= least)
          least = squared, found = i;
    if (found == faces.count) return false;
    task.farthest = std::max(task.farthest, least);
    faces.bare[found] -= kPerPoint;
    task.placed.push_back({point, faces.faces[found]});
    return true;
  };
  if (!place(v)) return false;
  for (const uint32_t h : ring.edges())
    if (!points_.allOf(h / 3, place)) return false;
  return std::all_of(faces.bare.begin(), faces.bare.begin() + faces.count,
                     [](double area) { return area <= 0.0; });
}

/// Returns whether points of the new edges are within the tolerance of the given mesh: the new faces meet
/// there, so they can be farther off than any point that was placed.
bool Decimator::staysNear(const Ring& ring, uint32_t k) const {
  const uint32_t end = mesh_.to(ring.all[k]);
  for (const uint32_t h : ring.edges()) {
    const uint32_t start = mesh_.to(h);
    if (start == end) continue;
    const int parts = partsOf(kEdgePoints * glm::distance(at(start), at(end)), options_.step);
    if (!given_.isNearEdge(start, end, parts)) return false;
  }
  return true;
}

bool Decimator::undoAt(std::span<const uint32_t> faces) {
  std::vector<uint32_t> changed;
  for (const uint32_t face : faces) {
    const uint32_t last = mesh_.lastCollapse(face);
    if (last == kNoIndex) continue;
    isKept_[last] = 1;
    mesh_.undo(last, [&](uint32_t v) {
      points_.take(v);
      Ring ring;
      mesh_.findRing(v, ring);
      wake_[v] = 0.0f;
      for (const uint32_t h : ring.edges()) {
        wake_[mesh_.to(h)] = 0.0f;
        changed.push_back(h / 3);
      }
    });
  }
  std::ranges::sort(changed);
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  points_.spread(changed, mesh_);
  return !changed.empty();
}

}  // namespace raymap
