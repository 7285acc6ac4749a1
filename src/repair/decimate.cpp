// Edge collapses in the order of quadric errors (Garland & Heckbert 1997), each one checked.

#include "repair/decimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/closest_point.h"
#include "repair/close_distances.h"
#include "repair/face_points.h"

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
// An edge is sharp if the other diagonal of its two faces is farther away than this share of the tolerance.
constexpr double kSharp = 0.25;
// A face with few points covers space where the given mesh has no surface. It may have an area, in squares of
// a step, of half a square, of two for each point, and of this for each step of its longest edge.
constexpr double kPerPoint = 2.0, kPerEdge = 0.1, kAlways = 0.5;
// New edges are measured if a point is farther from the new faces than this share of the tolerance.
constexpr double kNear = 0.4;

double squareOf(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// A triangle to measure distances from.
class FaceShape {
 public:
  FaceShape() = default;  // Left unset: each try has 24 and uses about six.
  FaceShape(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& normal)
      : corners_{a, b, c}, normal_(normal) {
    for (size_t k = 0; k < 3; ++k) {
      edges_[k] = corners_[(k + 1) % 3] - corners_[k];
      inwards_[k] = glm::cross(normal_, edges_[k]);
    }
  }

  /// Returns whether a point lies straight above or below the face, within a squared distance.
  bool isBeside(const glm::dvec3& p, double limit) const {
    return squaredHeight(p) <= limit && glm::dot(inwards_[0], p - corners_[0]) >= 0.0 &&
           glm::dot(inwards_[1], p - corners_[1]) >= 0.0 && glm::dot(inwards_[2], p - corners_[2]) >= 0.0;
  }

  double squaredHeight(const glm::dvec3& p) const {
    const double height = glm::dot(normal_, p - corners_[0]);
    return height * height;
  }

  double squaredDistance(const glm::dvec3& p) const {
    if (isBeside(p, INFINITY)) return squaredHeight(p);
    double least = INFINITY;
    for (size_t k = 0; k < 3; ++k) {
      const glm::dvec3 d = p - corners_[k];
      const double along = std::clamp(glm::dot(edges_[k], d) / squareOf(edges_[k]), 0.0, 1.0);
      least = std::min(least, squareOf(d - along * edges_[k]));
    }
    return least;
  }

 private:
  std::array<glm::dvec3, 3> corners_, edges_, inwards_;
  glm::dvec3 normal_;
};

enum class Nearness : uint8_t { Near, Far, Unsure };

/// Tells whether a point is within the square root of `limit` of a face, where rounding cannot matter.
Nearness guessNearness(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                       double limit) {
  // Errors stay below the margin for points and faces of this size, and for faces with this sine at a corner.
  constexpr double kMargin = 1e-6, kMostSquare = 1e12, kLeastSquaredSine = 1e-6;
  const glm::dvec3 ab = b - a, ac = c - a, normal = glm::cross(ab, ac), toPoint = p - a;
  const double area2 = squareOf(normal), height = glm::dot(normal, toPoint);
  if (squareOf(a) + squareOf(p) > kMostSquare * limit ||
      area2 <= kLeastSquaredSine * squareOf(ab) * squareOf(ac))
    return Nearness::Unsure;
  const double far = limit * (1.0 + kMargin) * area2;
  if (height * height > far) return Nearness::Far;
  bool isBeside = true;
  const auto isBeyond = [&](const glm::dvec3& edge, const glm::dvec3& fromEdge) {
    const double inwards = glm::dot(glm::cross(normal, edge), fromEdge);
    if (inwards >= 0.0) return false;
    isBeside = false;
    return inwards * inwards > far * squareOf(edge);
  };
  if (isBeyond(ab, toPoint) || isBeyond(c - b, p - b) || isBeyond(-ac, toPoint)) return Nearness::Far;
  return isBeside && height * height <= limit * (1.0 - kMargin) * area2 ? Nearness::Near : Nearness::Unsure;
}

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

void PlaneQuadric::addPlane(const glm::dvec3& n, const glm::dvec3& point, double weight) {
  const double d = -glm::dot(n, point);
  xx += weight * n.x * n.x, xy += weight * n.x * n.y, xz += weight * n.x * n.z;
  yy += weight * n.y * n.y, yz += weight * n.y * n.z, zz += weight * n.z * n.z;
  x += weight * d * n.x, y += weight * d * n.y, z += weight * d * n.z;
  one += weight * d * d;
}

void PlaneQuadric::add(const PlaneQuadric& other) {
  xx += other.xx, xy += other.xy, xz += other.xz, yy += other.yy, yz += other.yz, zz += other.zz;
  x += other.x, y += other.y, z += other.z, one += other.one;
}

double PlaneQuadric::meanSquare(const glm::dvec3& p) const {
  const double weight = xx + yy + zz;  // Normals have length 1.
  const double sum = p.x * (xx * p.x + 2.0 * (xy * p.y + xz * p.z + x)) +
                     p.y * (yy * p.y + 2.0 * (yz * p.z + y)) + p.z * (zz * p.z + 2.0 * z) + one;
  return weight > 0.0 ? std::max(sum, 0.0) / weight : 0.0;
}

Decimator::Decimator(const PackedMesh& mesh, const DecimateOptions& options)
    : vertices_(mesh.vertices),
      triangles_(mesh.triangles),
      options_(options),
      limit_(options.tolerance * options.tolerance),
      mesh_(mesh),
      normals_(mesh.triangles.size()),
      quadrics_(mesh.vertices.size()),
      points_(mesh.vertices.begin(), mesh.vertices.end()),
      firstPoint_(mesh.triangles.size(), kNoIndex),
      nextPoint_(mesh.vertices.size(), kNoIndex),
      faceOfPoint_(mesh.vertices.size(), kNoIndex),
      wake_(mesh.vertices.size()),
      tile_(mesh.vertices.size()),
      isFree_(mesh.vertices.size()),
      isKept_(mesh.vertices.size()) {
  listFaces();
  listNeighbours();
  addPlanes();
  addPoints();
}

void Decimator::listFaces() {
  firstFace_.resize(vertices_.size() + 2);
  facesOfVertex_.resize(3 * triangles_.size());
  for (const glm::uvec3& t : triangles_)
    for (int k = 0; k < 3; ++k) ++firstFace_[t[k] + 2];
  for (size_t v = 2; v < firstFace_.size(); ++v) firstFace_[v] += firstFace_[v - 1];
  for (uint32_t f = 0; f < triangles_.size(); ++f)
    for (int k = 0; k < 3; ++k) facesOfVertex_[firstFace_[triangles_[f][k] + 1]++] = f;
}

void Decimator::listNeighbours() {
  neighbours_.resize(facesOfVertex_.size());
  parallelFor(vertices_.size(), kPerTask, [&](size_t begin, size_t end) {
    for (auto v = uint32_t(begin); v < end; ++v) {
      auto next = neighbours_.begin() + firstFace_[v];
      const auto first = next;
      for (const uint32_t f : givenFaces(v))
        for (int k = 0; k < 3; ++k)
          if (const uint32_t other = triangles_[f][k]; other != v && std::find(first, next, other) == next)
            *next++ = other;
    }
  });
}

void Decimator::addPlanes() {
  parallelFor(normals_.size(), kPerTask, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const glm::uvec3 face = mesh_.face(uint32_t(f));
      const glm::dvec3 across = glm::cross(at(face.y) - at(face.x), at(face.z) - at(face.x));
      const double length = glm::length(across);
      normals_[f] = length > 0.0 ? glm::vec3(across / length) : glm::vec3(0.0f);
    }
  });
  parallelFor(quadrics_.size(), kPerTask, [&](size_t begin, size_t end) {
    Ring ring;
    for (auto v = uint32_t(begin); v < end; ++v) {
      if (!mesh_.hasVertex(v) || !mesh_.findRing(v, ring)) continue;
      for (const uint32_t h : ring.edges()) {
        const glm::dvec3 across = glm::cross(at(mesh_.to(h)) - at(v), at(mesh_.opposite(h)) - at(v));
        quadrics_[v].addPlane(glm::dvec3(normals_[h / 3]), at(v), glm::length(across));
      }
    }
  });
}

void Decimator::addPoint(uint32_t face, const glm::vec3& point) {
  points_.push_back(point);
  nextPoint_.push_back(kNoIndex);
  faceOfPoint_.push_back(kNoIndex);
  putPoint(uint32_t(points_.size() - 1), face);
}

void Decimator::putPoint(uint32_t point, uint32_t face) {
  nextPoint_[point] = firstPoint_[face];
  firstPoint_[face] = point;
  faceOfPoint_[point] = face;
}

void Decimator::takePoint(uint32_t point) {
  uint32_t* link = &firstPoint_[faceOfPoint_[point]];
  while (*link != point) link = &nextPoint_[*link];
  *link = nextPoint_[point];
  faceOfPoint_[point] = kNoIndex;
}

void Decimator::addPoints() {
  const double large = 2.0 * options_.step;
  for (uint32_t h = 0; h < 3 * mesh_.faceCount(); ++h) {
    const uint32_t t = mesh_.twin(h);
    if (t < h) continue;
    const glm::dvec3 a = at(mesh_.from(h)), b = at(mesh_.to(h)), c = at(mesh_.opposite(h));
    const glm::dvec3 across = at(mesh_.opposite(t)) - c, middle = 0.5 * (a + b) - c;
    const double along = std::clamp(glm::dot(middle, across) / std::max(squareOf(across), 1e-300), 0.0, 1.0);
    const double length = glm::distance(a, b);
    if (squareOf(middle - along * across) < kSharp * kSharp * limit_ && length <= large) continue;
    const int parts = std::max(static_cast<int>(std::min(length / options_.step, 1e6)), 1);
    forEachEdgePoint(a, b, parts, [&](const glm::dvec3& p) { addPoint(h / 3, glm::vec3(p)); });
  }
  for (uint32_t f = 0; f < mesh_.faceCount(); ++f) {
    const glm::uvec3 face = mesh_.face(f);
    const glm::dvec3 a = at(face.x), b = at(face.y), c = at(face.z);
    if (std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)}) > large)
      forEachFacePoint(a, b, c, options_.step, [&](const glm::dvec3& p) { addPoint(f, glm::vec3(p)); });
  }
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
  for (const uint32_t h : ring.edges()) firstPoint_[h / 3] = kNoIndex;
  for (const auto& [point, face] : task.placed) putPoint(point, face);
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
    const glm::dvec3 before = glm::cross(b - from, c - from), after = glm::cross(b - to, c - to);
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
    const glm::dvec3 p(points_[point]);
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
    for (uint32_t point = firstPoint_[h / 3]; point != kNoIndex; point = nextPoint_[point])
      if (!place(point)) return false;
  return std::all_of(faces.bare.begin(), faces.bare.begin() + faces.count,
                     [](double area) { return area <= 0.0; });
}

/// Returns whether points of the new edges are within the tolerance of the given mesh: the new faces meet
/// there, so they can be farther off than any point that was placed.
bool Decimator::staysNear(const Ring& ring, uint32_t k) const {
  const uint32_t end = mesh_.to(ring.all[k]);
  for (const uint32_t h : ring.edges()) {
    const uint32_t start = mesh_.to(h);
    if (start != end && !isNearGiven(start, end)) return false;
  }
  return true;
}

/// Returns whether points of an edge are within the tolerance of the given mesh, as far as a walk over its
/// vertices tells.
bool Decimator::isNearGiven(uint32_t start, uint32_t end) const {
  NearFace near{start};
  bool isNear = true;
  const glm::dvec3 a = at(start), b = at(end);
  forEachEdgePoint(a, b, partsOf(kEdgePoints * glm::distance(a, b), options_.step), [&](const glm::dvec3& p) {
    if (!isNear) return;
    if (const uint32_t vertex = walkTo(p, near.vertex); vertex != near.vertex) near = {vertex};
    isNear = isNearFacesOf(p, near) || std::ranges::any_of(givenNeighbours(near.vertex), [&](uint32_t v) {
               NearFace other{v};
               return isNearFacesOf(p, other);
             });
  });
  return isNear;
}

/// Goes from a given vertex to its neighbour closest to a point, and on while there is a closer one.
uint32_t Decimator::walkTo(const glm::dvec3& p, uint32_t vertex) const {
  uint32_t closest = vertex;
  double least = squareOf(at(vertex) - p);
  do {
    vertex = closest;
    for (const uint32_t v : givenNeighbours(vertex))
      if (const double squared = squareOf(at(v) - p); squared < least) least = squared, closest = v;
  } while (closest != vertex);
  return closest;
}

/// Returns whether a point is within the tolerance of the given faces around a vertex. Begins at the face
/// that was near the last point.
bool Decimator::isNearFacesOf(const glm::dvec3& p, NearFace& near) const {
  std::array<uint32_t, CollapsibleMesh::kMostValence> unsure;
  const std::span<const uint32_t> faces = givenFaces(near.vertex);
  size_t count = 0, k = near.place;
  for (size_t tried = 0; tried < faces.size(); ++tried, k = k + 1 < faces.size() ? k + 1 : 0) {
    const glm::uvec3 face = triangles_[faces[k]];
    const Nearness nearness = guessNearness(p, at(face.x), at(face.y), at(face.z), limit_);
    if (nearness == Nearness::Near) {
      near.place = uint32_t(k);
      return true;
    }
    if (nearness == Nearness::Far) continue;
    if (count == unsure.size()) return hasFaceWithin(faces, p);
    unsure[count++] = faces[k];
  }
  return hasFaceWithin({unsure.data(), count}, p);
}

/// Returns whether a point is within the tolerance of one of these given faces.
bool Decimator::hasFaceWithin(std::span<const uint32_t> faces, const glm::dvec3& p) const {
  return std::ranges::any_of(faces, [&](uint32_t f) {
    const glm::uvec3 face = triangles_[f];
    const cpu::TrianglePoint closest = cpu::closestPoint(p, at(face.x), at(face.y), at(face.z));
    return squareOf(closest.position - p) <= limit_;
  });
}

bool Decimator::undoAt(std::span<const uint32_t> faces) {
  std::vector<uint32_t> changed;
  for (const uint32_t face : faces) {
    const uint32_t last = mesh_.lastCollapse(face);
    if (last == kNoIndex) continue;
    isKept_[last] = 1;
    mesh_.undo(last, [&](uint32_t v) {
      takePoint(v);
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
  spreadPoints(changed);
  return !changed.empty();
}

/// Gives the points at these faces to the closest of them.
void Decimator::spreadPoints(std::span<const uint32_t> faces) {
  std::vector<uint32_t> numbers;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (const uint32_t f : faces) {
    triangles.push_back(mesh_.face(f));
    for (uint32_t point = firstPoint_[f]; point != kNoIndex; point = nextPoint_[point]) {
      numbers.push_back(point);
      positions.push_back(points_[point]);
    }
    firstPoint_[f] = kNoIndex;
  }
  if (numbers.empty()) return;
  const CloseDistances search({vertices_, triangles, glm::dvec3(0.0)}, INFINITY);
  const QueryResult found = search.measure(positions);
  for (size_t i = 0; i < numbers.size(); ++i) putPoint(numbers[i], faces[found.triangle[i]]);
}

}  // namespace raymap
