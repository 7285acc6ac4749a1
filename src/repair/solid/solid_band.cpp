// Krayer & Müller 2019, §4, end, on a narrow band: surface where the sign changes and no triangle is. The
// surface itself is made by method/close_holes_patch.cpp.

#include "repair/solid/solid_band.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/parallel.h"
#include "cpu/points/face_crossings.h"
#include "cpu/points/narrow_band.h"
#include "cpu/points/point_cells.h"
#include "cpu/points/point_query.h"
#include "cpu/points/segment_crossings.h"
#include "field/leaf_order.h"
#include "isosurface/contour_rows.h"
#include "method/turns.h"

namespace raymap {

namespace {

constexpr size_t kRowsPerTask = 16;

/// A lattice edge at which the sign changes, from the lowest corner of a cube along an axis.
struct SignChange {
  size_t cube;
  int axis;
  glm::ivec3 first;
};

/// Finds the lattice edges of a narrow band at which the sign changes and no triangle crosses.
class MissingEdges {
 public:
  MissingEdges(const cpu::PreparedSurface& surface, const Field& band, Progress& progress)
      : surface_(surface),
        grid_(band.grid),
        found_(findCubes(band, 0.0, progress)),
        slack_(cpu::slackOf(surface.tree, surface.grid.dims)) {
    markCrossed(band);
  }

  /// Returns them, but for their winding numbers.
  std::vector<SignChange> find() const {
    std::vector<SignChange> missing;
    forEachChange(0, found_.rows.size(), [&](const SignChange& change) {
      if (!(isCrossed_[change.cube] >> change.axis & 1)) missing.push_back(change);
    });
    return missing;
  }

  /// Returns bit c for cube c around an edge: whether triangles cross a sign change of the cube.
  unsigned rimCubes(const SignChange& edge) const {
    unsigned bits = 0;
    for (uint32_t c = 0; c < kCubesAround; ++c)
      bits |= hasCrossedChange(cubeAround(edge.first, edge.axis, int(c))) ? 1u << c : 0u;
    return bits;
  }

 private:
  /// Calls `visit(change)` for the changes at the own edges of the cubes in some rows. Leaves out edges that
  /// leave the grid.
  template <class Visit>
  void forEachChange(size_t beginRow, size_t endRow, Visit&& visit) const {
    for (size_t row = beginRow; row < endRow; ++row)
      for (size_t c = found_.begin[row]; c < found_.begin[row + 1]; ++c) {
        const ContourCube& cube = found_.cubes[c];
        const glm::ivec3 first = glm::ivec3(cube.x, found_.rows[row].y, found_.rows[row].z) - 1;
        if (glm::any(glm::lessThan(first, glm::ivec3(0)))) continue;
        for (int axis = 0; axis < 3; ++axis)
          if (first[axis] + 1 < grid_.dims[axis] && cube.isCrossed(axis)) visit(SignChange{c, axis, first});
      }
  }

  /// Marks the edges that triangles cross.
  void markCrossed(const Field& band) {
    isCrossed_.resize(found_.cubes.size());
    parallelFor(found_.rows.size(), kRowsPerTask, [&](size_t begin, size_t end) {
      std::vector<uint32_t> faces;
      forEachChange(begin, end, [&](const SignChange& change) {
        if (std::abs(band.distanceAt(change.first)) <= grid_.spacing * (1.0 + 1e-5) &&
            isCrossed(change, faces))
          isCrossed_[change.cube] |= uint8_t(1 << change.axis);
      });
    });
  }

  /// Returns whether the faces that cross an edge change the winding number. `faces` is room to work in.
  bool isCrossed(const SignChange& change, std::vector<uint32_t>& faces) const {
    glm::ivec3 last = change.first;
    ++last[change.axis];
    const glm::dvec3 from = grid_.position(glm::dvec3(change.first)), to = grid_.position(glm::dvec3(last));
    const cpu::SurfaceTree& tree = surface_.signTree();
    cpu::findTrianglesAlong(tree, cpu::toCells(surface_.grid, from), cpu::toCells(surface_.grid, to), slack_,
                            faces);
    for (uint32_t& face : faces) face = tree.triangleId(face);
    const glm::dvec3& origin = surface_.mesh.origin;
    return cpu::countFaceCrossings(surface_.mesh, surface_.turns, faces, from - origin, to - origin) != 0;
  }

  bool hasCrossedChange(const glm::ivec3& cube) const {
    if (glm::any(glm::equal(cube, glm::ivec3(0))) || glm::any(glm::equal(cube, grid_.dims))) return false;
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 4; ++corner) {
        glm::ivec3 owner = cube;
        owner[(axis + 1) % 3] += corner & 1;
        owner[(axis + 2) % 3] += corner >> 1;
        if (crossedOf(owner) >> axis & 1) return true;
      }
    return false;
  }

  /// Returns the marks of a cube's own edges.
  unsigned crossedOf(const glm::ivec3& place) const {
    const ContourRows::Row wanted{place.z, place.y};
    const auto row = std::ranges::lower_bound(found_.rows, wanted);
    if (row == found_.rows.end() || *row != wanted) return 0;
    const auto r = size_t(row - found_.rows.begin());
    const auto first = found_.cubes.begin() + ptrdiff_t(found_.begin[r]),
               last = found_.cubes.begin() + ptrdiff_t(found_.begin[r + 1]);
    const auto cube =
        std::lower_bound(first, last, place.x, [](const ContourCube& each, int x) { return each.x < x; });
    return cube == last || cube->x != place.x ? 0u : isCrossed_[size_t(cube - found_.cubes.begin())];
  }

  const cpu::PreparedSurface& surface_;
  const Grid& grid_;
  ContourRows found_;
  float slack_;
  std::vector<uint8_t> isCrossed_;  // Of each cube, bit a: its own edge along axis a.
};

/// Returns winding numbers of points in samples.
std::vector<float> windingAt(const cpu::PreparedSurface& surface, const Grid& grid,
                             std::span<const glm::vec3> points) {
  std::vector<glm::dvec3> positions;
  positions.reserve(points.size());
  for (const glm::vec3& p : points) positions.push_back(grid.position(glm::dvec3(p)));
  Progress quiet;
  QueryResult found;
  cpu::queryPoints(surface, PointsView(positions), {.distance = false, .winding = true}, quiet, found);
  return {found.winding.begin(), found.winding.end()};
}

/// Returns a part of a lattice that holds all samples beside some edges, or none if 32 bits do not number its
/// samples.
std::optional<Region> regionAround(std::span<const SignChange> edges, const glm::ivec3& dims) {
  glm::ivec3 low = dims, high(0);
  for (const SignChange& edge : edges) low = glm::min(low, edge.first), high = glm::max(high, edge.first);
  low = glm::max(low - 2, 0);
  high = glm::min(high + 4, dims);
  const Region region{low, high - low};
  const double samples = double(region.size.x) * region.size.y * region.size.z;
  if (samples >= double(UINT32_MAX)) return std::nullopt;
  return region;
}

/// Makes the surface that closes holes, in the samples of `part`, a part of the lattice.
void closeHoles(const cpu::PreparedSurface& surface, const MissingEdges& missing, const Grid& part,
                const glm::ivec3& low, std::span<const SignChange> edges, const Field& band,
                Progress& progress, HolePatch& patch) {
  std::vector<MissingEdge> asked;
  std::vector<glm::vec3> ends;
  for (const SignChange& edge : edges) {
    const glm::ivec3 first = edge.first - low;
    glm::ivec3 last = first;
    ++last[edge.axis];
    asked.push_back({uint32_t(part.index(first)), uint32_t(edge.axis), missing.rimCubes(edge), {}});
    ends.insert(ends.end(), {glm::vec3(first), glm::vec3(last)});
  }
  const std::vector<float> winding = windingAt(surface, part, ends);
  const auto threshold = static_cast<float>(surface.threshold);
  for (size_t e = 0; e < asked.size(); ++e) {
    // The side is that of the band, should rounding have another opinion.
    const bool startsInside = band.distanceAt(edges[e].first) < 0.0f;
    for (size_t end = 0; end < 2; ++end) {
      const float number = std::abs(winding[2 * e + end]);
      asked[e].winding[end] = startsInside == (end == 0)
                                  ? std::max(number, std::nextafter(threshold, INFINITY))
                                  : std::min(number, threshold);
    }
  }
  std::ranges::sort(asked, {}, [](const MissingEdge& e) { return std::pair(e.first, e.axis); });
  CellMesh cells;
  toCellUnits(surface.mesh, part, cells);
  const auto source = [&](std::span<const glm::vec3> points) { return windingAt(surface, part, points); };
  makePatch(cells, asked, surface.threshold, source, progress, patch);
}

/// Makes a surface with a patch, for distances, of one without. Signs stay those of the mesh.
class PatchedSurface {
 public:
  PatchedSurface(cpu::PreparedSurface& surface, const HolePatch& patch, const Grid& part)
      : surface_(surface), given_(surface.mesh) {
    vertices_.assign(given_.vertices.begin(), given_.vertices.end());
    triangles_.assign(given_.triangles.begin(), given_.triangles.end());
    const auto first = uint32_t(vertices_.size());
    for (const glm::vec3& p : patch.mesh.vertices)
      vertices_.emplace_back(part.position(glm::dvec3(p)) - given_.origin);
    for (const glm::uvec3& t : patch.triangles) triangles_.push_back(t + first);
    surface_.mesh = {vertices_, triangles_, given_.origin};
    givenTree_ = std::move(surface_.tree);
    surface_.tree = cpu::prepareUnsigned(surface_.mesh, surface_.grid).tree;
    if (!surface_.turnedTree) surface_.turnedTree = std::move(givenTree_), hasMoved_ = true;
  }
  PatchedSurface(const PatchedSurface&) = delete;
  ~PatchedSurface() {
    if (hasMoved_) givenTree_ = *std::move(surface_.turnedTree), surface_.turnedTree.reset();
    surface_.tree = std::move(givenTree_);
    surface_.mesh = given_;
  }

 private:
  cpu::PreparedSurface& surface_;
  PackedMesh given_;
  cpu::SurfaceTree givenTree_;
  bool hasMoved_ = false;
  std::vector<glm::vec3> vertices_;
  std::vector<glm::uvec3> triangles_;
};

}  // namespace

ClosedBand makeClosedBand(cpu::PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                          bool closesHoles, size_t most, Progress& progress) {
  constexpr double kBeside = 1.25;  // Samples beside the surface that tell which edges triangles cross.
  if (!closesHoles || surface.lattice.isWhole())
    return {makeNarrowBand(surface, grid, options, most, progress)};
  ClosedBand closed;
  HolePatch patch;
  Grid part = grid;
  {
    const Field band = makeNarrowBand(surface, grid, {.outside = kBeside, .inside = kBeside}, most, progress);
    progress.stage("close_holes", [&] {
      const MissingEdges missing(surface, band, progress);
      const std::vector<SignChange> edges = missing.find();
      const std::optional<Region> region = regionAround(edges, grid.dims);
      if (edges.empty() || !region) return;
      requirePatch(edges.size(), cpu::SurfaceTree::bytesNeeded(2 * edges.size(), surface.tree.frames()),
                   most - std::min(most, surface.bytes() + band.bytes()));
      part.origin = grid.position(glm::dvec3(region->low));
      part.dims = region->size;
      closeHoles(surface, missing, part, region->low, edges, band, progress, patch);
    });
  }
  if (patch.triangles.empty()) return {makeNarrowBand(surface, grid, options, most, progress)};
  closed.patchTriangles = patch.triangles.size();
  closed.patchArea = patch.area() * grid.spacing * grid.spacing;
  const PatchedSurface patched(surface, patch, part);
  closed.field = makeNarrowBand(surface, grid, options, most, progress);
  return closed;
}

Field makePlateBand(const PackedMesh& mesh, const Grid& grid, double radius, double width, size_t most,
                    Progress& progress) {
  const cpu::PreparedSurface surface = cpu::prepareUnsigned(mesh, fitGrid(mesh));
  const double reach = (radius + width) / grid.spacing;
  Field band = makeNarrowBand(surface, grid, {.outside = reach, .inside = reach}, most, progress);
  for (float& d : band.distance) d = static_cast<float>(double(d) - radius);
  band.narrow->outside -= radius;
  return band;
}

void unite(Field& solid, const Field& other) {
  constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
  NarrowBand& band = *solid.narrow;
  const auto width = static_cast<float>(band.outside), far = static_cast<float>(other.narrow->outside);
  std::vector<size_t> added;
  for (size_t leaf = 0; leaf < other.narrow->leaves.size(); ++leaf) {
    const glm::ivec3& low = other.narrow->leaves[leaf];
    const float* values = other.distance.data() + leaf * kLeafSamples;
    if (const std::optional<size_t> place = band.find(low))
      for (size_t s = 0; s < kLeafSamples; ++s) {
        if (values[s] < far) solid.distance[*place + s] = std::min(solid.distance[*place + s], values[s]);
      }
    else if (solid.distanceAt(low) > 0.0f)
      added.push_back(leaf);
  }
  if (added.empty()) return;
  Buffer<glm::ivec3> leaves;
  Buffer<float> distance;
  leaves.resizeUninitialized(band.leaves.size() + added.size());
  distance.resizeUninitialized(leaves.size() * kLeafSamples);
  size_t own = 0, next = 0;
  for (size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    const bool isOwn =
        next == added.size() ||
        (own < band.leaves.size() && comesBefore(band.leaves[own], other.narrow->leaves[added[next]]));
    const size_t from = isOwn ? own++ : added[next++];
    leaves[leaf] = (isOwn ? band : *other.narrow).leaves[from];
    const float* values = (isOwn ? solid : other).distance.data() + from * kLeafSamples;
    std::transform(values, values + kLeafSamples, distance.data() + leaf * kLeafSamples,
                   [&](float d) { return isOwn || d < far ? d : width; });
  }
  band.leaves = std::move(leaves);
  solid.distance = std::move(distance);
}

}  // namespace raymap
