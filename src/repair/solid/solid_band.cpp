// Krayer & Müller 2019, §4, end, on a narrow band: surface where the sign changes and no triangle is. The
// surface itself is made by method/close_holes_patch.cpp.

#include "repair/solid/solid_band.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "cpu/points/face_crossings.h"
#include "cpu/points/lattice_query.h"
#include "cpu/points/narrow_band.h"
#include "cpu/points/point_query.h"
#include "field/leaf_order.h"
#include "isosurface/contour_rows.h"

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
      : surface_(surface), grid_(band.grid), found_(findCubes(band, 0.0, progress)) {
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
    return cpu::crossingsBetween(surface_, from, to, faces) != 0;
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

/// Appends what is left of a tile without the leaves that it has to make room for.
void cutTile(const NarrowBand::Tile& tile, std::span<const glm::ivec3> leaves,
             std::vector<NarrowBand::Tile>& rest) {
  const auto first = std::ranges::lower_bound(leaves, tile.low, comesBefore);
  if (first == leaves.end() || glm::any(glm::greaterThanEqual(*first - tile.low, glm::ivec3(tile.side)))) {
    rest.push_back(tile);
    return;
  }
  const int half = tile.side / 2;
  if (half < NarrowBand::kLeafSide) return;
  for (int child = 0; child < 8; ++child)
    cutTile({tile.low + half * cpu::cornerOf(child), half}, leaves, rest);
}

/// Sets the samples of a leaf that lie beyond the grid.
void setBeyond(const glm::ivec3& dims, const glm::ivec3& low, float value, float* values) {
  constexpr int kSide = NarrowBand::kLeafSide;
  if (glm::all(glm::lessThanEqual(low + kSide, dims))) return;
  for (int s = 0; s < int(NarrowBand::kLeafSamples); ++s) {
    const glm::ivec3 sample = low + glm::ivec3(s % kSide, s / kSide % kSide, s / kSide / kSide);
    if (glm::any(glm::greaterThanEqual(sample, dims))) values[s] = value;
  }
}

/// Inserts leaves of another narrow band on the same grid, with `fill(own, other's)` at their samples.
template <class Fill>
void insertLeaves(Field& solid, const Field& other, std::span<const size_t> added, Fill&& fill) {
  constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
  NarrowBand& band = *solid.narrow;
  std::vector<glm::ivec3> lows;
  for (const size_t leaf : added) lows.push_back(other.narrow->leaves[leaf]);
  Buffer<glm::ivec3> leaves;
  Buffer<float> distance;
  leaves.resizeUninitialized(band.leaves.size() + added.size());
  distance.resizeUninitialized(leaves.size() * kLeafSamples);
  size_t own = 0, next = 0;
  for (size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    const bool isOwn =
        next == added.size() || (own < band.leaves.size() && comesBefore(band.leaves[own], lows[next]));
    leaves[leaf] = isOwn ? band.leaves[own] : lows[next];
    float* values = distance.data() + leaf * kLeafSamples;
    if (isOwn) {
      std::copy_n(solid.distance.data() + own++ * kLeafSamples, kLeafSamples, values);
      continue;
    }
    const float* from = other.distance.data() + added[next] * kLeafSamples;
    const float base = solid.distanceAt(lows[next++]);
    std::transform(from, from + kLeafSamples, values, [&](float d) { return fill(base, d); });
    setBeyond(solid.grid.dims, leaves[leaf], float(band.outside), values);
  }
  std::vector<NarrowBand::Tile> tiles;
  for (const NarrowBand::Tile& tile : band.tiles) cutTile(tile, lows, tiles);
  band.tiles = std::move(tiles);
  band.leaves = std::move(leaves);
  solid.distance = std::move(distance);
}

/// Replaces values of a narrow band by `fill(value, other's)`. `other` is a narrow band on the same grid
/// without tiles. Its leaves are inserted where `isWanted(value)` for a band's value without a leaf.
template <class IsWanted, class Fill>
void merge(Field& solid, const Field& other, IsWanted&& isWanted, Fill&& fill) {
  constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
  std::vector<size_t> added;
  for (size_t leaf = 0; leaf < other.narrow->leaves.size(); ++leaf) {
    const glm::ivec3& low = other.narrow->leaves[leaf];
    const float* values = other.distance.data() + leaf * kLeafSamples;
    if (const std::optional<size_t> place = solid.narrow->find(low))
      std::transform(values, values + kLeafSamples, solid.distance.data() + *place,
                     solid.distance.data() + *place, [&](float d, float own) { return fill(own, d); });
    else if (isWanted(solid.distanceAt(low)))
      added.push_back(leaf);
  }
  if (!added.empty()) insertLeaves(solid, other, added, fill);
}

/// Makes the distances of a band lead to a patch, too. Signs stay.
void addPatch(Field& band, const HolePatch& patch, const Grid& part, size_t most, Progress& progress) {
  Mesh mesh;
  mesh.origin = band.grid.origin;
  for (const glm::vec3& p : patch.mesh.vertices)
    mesh.vertices.emplace_back(part.position(glm::dvec3(p)) - mesh.origin);
  mesh.triangles.assign(patch.triangles.begin(), patch.triangles.end());
  const double width = std::max(band.narrow->outside, band.narrow->inside);
  const Field other = makePlateBand(mesh, band.grid, 0.0, width, most, progress);
  const auto always = [](float) { return true; };
  merge(band, other, always,
        [](float own, float d) { return d < std::abs(own) ? std::copysign(d, own) : own; });
}

}  // namespace

ClosedBand makeClosedBand(const cpu::PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                          bool closesHoles, size_t most, Progress& progress) {
  ClosedBand closed{makeNarrowBand(surface, grid, options, most, progress)};
  if (!closesHoles || surface.lattice.isWhole()) return closed;
  HolePatch patch;
  Grid part = grid;
  progress.stage("close_holes", [&] {
    const MissingEdges missing(surface, closed.field, progress);
    const std::vector<SignChange> edges = missing.find();
    const std::optional<Region> region = regionAround(edges, grid.dims);
    if (edges.empty() || !region) return;
    requirePatch(edges.size(), cpu::SurfaceTree::bytesNeeded(2 * edges.size(), surface.tree.frames()),
                 most - std::min(most, surface.bytes() + closed.field.bytes()));
    part.origin = grid.position(glm::dvec3(region->low));
    part.dims = region->size;
    closeHoles(surface, missing, part, region->low, edges, closed.field, progress, patch);
  });
  if (patch.triangles.empty()) return closed;
  closed.patchTriangles = patch.triangles.size();
  closed.patchArea = patch.area() * grid.spacing * grid.spacing;
  addPatch(closed.field, patch, part, most, progress);
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
  const auto far = static_cast<float>(other.narrow->outside);
  const auto isOutside = [](float own) { return own > 0.0f; };
  merge(solid, other, isOutside, [&](float own, float d) { return d < far ? std::min(own, d) : own; });
}

}  // namespace raymap
