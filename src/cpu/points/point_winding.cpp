// Ours: the winding number of scattered points (Krayer & Müller 2019, §3.5, know the lattice's samples only).
//
// On the way from a sample to a point, the number changes by the crossings of faces, as along the paper's
// rays. Where the surface has holes it changes between faces, too. If the change could matter, the dipoles
// decide.

#include "cpu/points/point_winding.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <cmath>

#include "cpu/points/face_crossings.h"

namespace raymap::cpu {

namespace {

/// Segments do not begin at a sample but at this offset from it, in cells: meshes often have edges in the
/// planes and on the lines of a lattice.
const glm::vec3 kOffset(0.0137f, 0.0291f, 0.0213f);

/// A sample is used only if the surface is at least so far, in cells. The offset is much shorter.
constexpr float kClear = 0.1f;

}  // namespace

PointWinding::PointWinding(const WindingSource& source)
    : source_(source), dims_(source.lattice.grid.dims), slack_(slackOf(source.tree, dims_)) {
  const glm::ivec3 step = glm::min(dims_ - 1, 1);
  for (int c = 0; c < int(kCorners); ++c)
    offsets_[c] =
        static_cast<uint32_t>(source.lattice.grid.index(step * glm::ivec3(c & 1, c >> 1 & 1, c >> 2)));
}

bool PointWinding::isOutside(const glm::vec3& p) const {
  return glm::any(glm::lessThan(p, glm::vec3(0.0f))) || glm::any(glm::greaterThan(p, glm::vec3(dims_ - 1)));
}

bool PointWinding::isNearRim(const glm::vec3& p) const {
  const Buffer<uint8_t>& marks = source_.lattice.isNearRim;
  return !marks.empty() && marks[source_.lattice.grid.index(glm::ivec3(p))] != 0;
}

size_t PointWinding::nearestSample(const glm::vec3& p) const {
  const glm::ivec3 s(glm::clamp(p + 0.5f, glm::vec3(0.0f), glm::vec3(dims_ - 1)));
  return source_.lattice.grid.index(s);
}

glm::vec3 PointWinding::place(uint32_t sample) const {
  const glm::uvec3 d(dims_);
  return glm::vec3(sample % d.x, sample / d.x % d.y, sample / d.x / d.y);
}

PointWinding::Reference PointWinding::findReference(const glm::vec3& p, float distance) const {
  const glm::ivec3 low = glm::clamp(glm::ivec3(p), glm::ivec3(0), glm::max(dims_ - 2, 0));
  const size_t first = source_.lattice.grid.index(low);
  const glm::vec3 d = p - glm::vec3(low), e = d - 1.0f, d2 = d * d, e2 = e * e;
  float clear[kCorners], length2[kCorners], reach[kCorners];
  for (uint32_t c = 0; c < kCorners; ++c) {
    clear[c] = source_.lattice.distance[first + offsets_[c]];
    length2[c] = (c & 1 ? e2.x : d2.x) + (c & 2 ? e2.y : d2.y) + (c & 4 ? e2.z : d2.z);
    reach[c] = clear[c] + distance - 2.0f * slack_;
  }
  Reference best;
  float nearest = INFINITY;
  for (uint32_t c = 0; c < kCorners; ++c) {
    const auto sample = static_cast<uint32_t>(first + offsets_[c]);
    // The balls around both that hold no face cover the way.
    if (reach[c] > 0.0f && reach[c] * reach[c] > length2[c]) return {sample, true};
    if (clear[c] >= kClear && length2[c] < nearest) best = {sample, false}, nearest = length2[c];
  }
  return best;
}

/// Returns whether the number's side of the threshold is sure, although it comes from the lattice. Away from
/// rims it changes by less than the lattice's error between a sample and the point, but for crossings.
bool PointWinding::isSettled(float winding, float distance) const {
  if (source_.lattice.isWhole()) return true;
  const float gap = std::abs(std::abs(winding) - static_cast<float>(source_.threshold));
  return gap >= 2.0f * latticeError(distance);
}

/// Computes the numbers of those points that have crossings from a sample. Unsure ones become NaN.
void PointWinding::crossFrom(uint32_t sample, const WindingPoints& points, std::span<const uint32_t> which,
                             std::span<float> winding) {
  ends_.clear();
  for (const uint32_t i : which) ends_.push_back(points.cells[i]);
  changes_.resize(which.size());
  countCrossings(source_.tree, place(sample) + kOffset, ends_, slack_, changes_);
  for (size_t k = 0; k < which.size(); ++k)
    winding[which[k]] =
        changes_[k] == kUnsure ? NAN : source_.lattice.winding[sample] + static_cast<float>(changes_[k]);
}

/// Returns whether crossings in double precision may decide. They always may if all numbers are whole. Else
/// only away from rims, for points that single precision cannot tell from the surface.
bool PointWinding::mayCrossExactly(const glm::vec3& p, float distance) const {
  return source_.lattice.isWhole() || (distance <= slack_ && !isOutside(p) && !isNearRim(p));
}

/// Computes a number by crossings in double precision, from a sample around the point. If all numbers are
/// whole, tries all of these, and at last the lattice's first, which lies outside. Returns false if it stays
/// unsure: then perhaps the point lies on the surface.
bool PointWinding::crossExactly(const glm::dvec3& p, const glm::vec3& cells, float& winding) {
  const Grid& grid = source_.lattice.grid;
  const glm::ivec3 low = glm::clamp(glm::ivec3(cells), glm::ivec3(0), glm::max(dims_ - 2, 0));
  const bool isWhole = source_.lattice.isWhole();
  for (uint32_t c = 0; c < kCorners + uint32_t{isWhole}; ++c) {
    const glm::ivec3 corner =
        c < kCorners ? glm::min(low + glm::ivec3(c & 1, c >> 1 & 1, c >> 2), dims_ - 1) : glm::ivec3(0);
    const size_t sample = grid.index(corner);
    if (source_.lattice.distance[sample] < kClear) continue;
    const glm::vec3 from = glm::vec3(corner) + kOffset;
    findTrianglesAlong(source_.tree, from, cells, slack_, faces_);
    for (uint32_t& t : faces_) t = source_.tree.triangleId(t);
    const glm::dvec3 exactFrom = grid.position(from) - source_.mesh.origin;
    const int32_t change = countFaceCrossings(source_.mesh, source_.turns, faces_, exactFrom, p);
    if (change != kUnsure) {
      winding = source_.lattice.winding[sample] + static_cast<float>(change);
      return true;
    }
    if (!isWhole) return false;
  }
  return false;
}

void PointWinding::compute(const WindingPoints& points, std::span<float> winding) {
  const bool isWhole = source_.lattice.isWhole();
  asked_.clear();
  crossing_.clear();
  for (uint32_t i = 0; i < points.cells.size(); ++i) {
    const glm::vec3& p = points.cells[i];
    const bool isBeyond = isOutside(p);
    winding[i] = isBeyond && isWhole ? 0.0f : NAN;
    if (isBeyond || isNearRim(p)) continue;
    const Reference reference = findReference(p, points.distance[i]);
    if (reference.sample == Reference::kNone) continue;
    if (reference.isVisible)
      winding[i] = source_.lattice.winding[reference.sample];
    else
      crossing_.push_back(uint64_t{reference.sample} << 32 | i);
  }
  hwy::Sorter()(crossing_.data(), crossing_.size(), hwy::SortAscending());
  for (size_t begin = 0, end = 0; begin < crossing_.size(); begin = end) {
    const auto sample = uint32_t(crossing_[begin] >> 32);
    asked_.clear();
    for (; end < crossing_.size() && crossing_[end] >> 32 == sample; ++end)
      asked_.push_back(uint32_t(crossing_[end]));
    crossFrom(sample, points, asked_, winding);
  }
  asked_.clear();
  ends_.clear();
  for (uint32_t i = 0; i < points.cells.size(); ++i) {
    if (std::isnan(winding[i]) && mayCrossExactly(points.cells[i], points.distance[i]))
      crossExactly(points.exact[i], points.cells[i], winding[i]);
    if (!std::isnan(winding[i]) && isSettled(winding[i], points.distance[i])) continue;
    asked_.push_back(i);
    ends_.push_back(points.cells[i]);
  }
  numbers_.resize(asked_.size());
  source_.dipoles.settleAt(source_.tree, ends_, source_.threshold, 0, numbers_);
  for (size_t k = 0; k < asked_.size(); ++k) winding[asked_[k]] = numbers_[k];
}

void PointWinding::computeClosely(const WindingPoints& points, std::span<float> winding) {
  if (source_.lattice.isWhole()) {
    compute(points, winding);
    return;
  }
  source_.dipoles.settleAt(source_.tree, points.cells, source_.threshold, 1, winding);
  for (size_t i = 0; i < points.cells.size(); ++i) {
    if (!mayCrossExactly(points.cells[i], points.distance[i])) continue;
    float crossed = NAN;
    if (crossExactly(points.exact[i], points.cells[i], crossed) && isSettled(crossed, points.distance[i]))
      winding[i] += std::round(crossed - winding[i]);
  }
}

}  // namespace raymap::cpu
