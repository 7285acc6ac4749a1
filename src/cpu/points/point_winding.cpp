// Ours: the winding number of scattered points (Krayer & Müller 2019, §3.5, know the lattice's samples only).
//
// On the way from a sample to a point, the number changes by the crossings of faces, as along the paper's
// rays. Where the surface has holes it changes between faces, too, by what the rims say. Where there are too
// many rims and the change could matter, the dipoles decide.

#include "cpu/points/point_winding.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cpu/points/face_crossings.h"
#include "cpu/sign/sign.h"
#include "method/winding_dipoles_shared.h"
#include "method/winding_doubts_shared.h"

namespace raymap::cpu {

namespace {

/// Segments do not begin at a sample but at this offset from it, in cells: meshes often have edges in the
/// planes and on the lines of a lattice.
const glm::vec3 kOffset(0.0137f, 0.0291f, 0.0213f);

/// A sample is used only if the surface is at least so far, in cells. The offset is much shorter.
constexpr float kClear = 0.1f;

/// A way to a point that passes rims by less than this is taken only if there is no better one.
constexpr double kSafeClearance = 1e-4;

/// A number changes by up to so much between a sample and a point, but for crossings, where no rim is near,
/// or by up to so many times what it changes between the samples around the point.
constexpr float kLeastChange = 0.15f, kBend = 1.5f;

/// A sample is used only if its number is known better than this.
constexpr double kMostDoubt = 0.2;

/// An end in a face moves back by this share of the way.
constexpr double kBack = 1e-9;

/// Points that are this many times the lattice's size away see no winding.
constexpr float kOutOfSight = 5e3f;

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

float PointWinding::confidence(const glm::vec3& p, double winding) const {
  return marginOf(float(winding), float(source_.threshold)) * source_.lattice.agreement[nearestSample(p)];
}

/// Returns the index of the sample closest to a point.
size_t PointWinding::nearestSample(const glm::vec3& p) const {
  const glm::ivec3 s(glm::clamp(p + 0.5f, glm::vec3(0.0f), glm::vec3(dims_ - 1)));
  return source_.lattice.grid.index(s);
}

glm::vec3 PointWinding::place(uint32_t sample) const {
  const glm::uvec3 d(dims_);
  return glm::vec3(sample % d.x, sample / d.x % d.y, sample / d.x / d.y);
}

PointWinding::Reference PointWinding::findReference(const glm::vec3& p, float distance) const {
  const glm::ivec3 low = lowestCorner(p);
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

/// Returns how far a number may be wrong that comes from a sample at this distance from the surface.
float PointWinding::doubtFrom(const glm::vec3& p, float distance) const {
  if (source_.lattice.isWhole()) return 0.0f;
  const size_t first = source_.lattice.grid.index(lowestCorner(p));
  float change = 0.0f;
  for (const uint32_t axis : {1u, 2u, 4u}) {
    float most = 0.0f;
    for (uint32_t c = 0; c < kCorners; ++c) {
      const float step = source_.lattice.winding[first + offsets_[c | axis]] -
                         source_.lattice.winding[first + offsets_[c & ~axis]];
      most = std::max(most, std::abs(step - std::round(step)));
    }
    change += most;
  }
  return latticeError(distance) + std::max(kLeastChange, kBend * change);
}

/// Returns whether the number's side of the threshold is sure.
bool PointWinding::isSettled(double winding, float doubt) const {
  return source_.lattice.isWhole() || std::abs(std::abs(winding) - source_.threshold) >= doubt;
}

/// Returns the lowest sample of the cell that has a point, or of the nearest cell.
glm::ivec3 PointWinding::lowestCorner(const glm::vec3& p) const {
  return glm::clamp(glm::ivec3(p), glm::ivec3(0), glm::max(dims_ - 2, 0));
}

/// Computes the numbers of those points that have crossings from a sample. Unsure ones become NaN.
void PointWinding::crossFrom(uint32_t sample, const WindingPoints& points, std::span<const uint32_t> which,
                             std::span<double> winding) {
  ends_.clear();
  for (const uint32_t i : which) ends_.push_back(points.cells[i]);
  changes_.resize(which.size());
  countCrossings(source_.tree, place(sample) + kOffset, ends_, slack_, changes_);
  for (size_t k = 0; k < which.size(); ++k)
    winding[which[k]] =
        changes_[k] == kUnsure ? NAN : source_.lattice.winding[sample] + static_cast<double>(changes_[k]);
}

/// Counts crossings in double precision. An end in a face is moved out of it.
int32_t PointWinding::crossingsFrom(const glm::vec3& from, const glm::vec3& cells,
                                    const glm::dvec3& exactFrom, const glm::dvec3& p) {
  findTrianglesAlong(source_.tree, from, cells, slack_, faces_);
  for (uint32_t& t : faces_) t = source_.tree.triangleId(t);
  const int32_t change = countFaceCrossings(source_.mesh, source_.turns, faces_, exactFrom, p);
  if (change != kUnsure) return change;
  return countFaceCrossings(source_.mesh, source_.turns, faces_, exactFrom, p + kBack * (exactFrom - p));
}

/// Computes a point's number from that of a sample. Its clearance is 0 if the sample is of no use.
RimShare PointWinding::numberFrom(uint32_t sample, const WindingPoints& points, size_t i) {
  if (source_.lattice.distance[sample] < kClear) return {NAN, 0.0};
  const glm::vec3 from = place(sample) + kOffset;
  const glm::dvec3 exactFrom = source_.lattice.grid.position(from) - source_.mesh.origin, p = points.exact[i];
  const int32_t change = crossingsFrom(from, points.cells[i], exactFrom, p);
  if (change == kUnsure) return {NAN, 0.0};
  const double known = source_.lattice.winding[sample];
  if (source_.rims.count() == 0) return {known + change, 1.0};  // Whole, or too many.
  // Both lie on one ray. The sample's number tells how many crossings lie beyond it.
  const glm::dvec3 way = exactFrom - p, direction = way / glm::length(way);
  constexpr double kWhole = 0.1;  // Enough to round to a whole number.
  const RimShare there = source_.rims.at(exactFrom, direction, kWhole);
  RimShare here = source_.rims.at(p, direction, allowed_);
  const double beyond = std::round(known - there.winding), whole = beyond + change;
  if (std::abs(known - there.winding - beyond) > kMostDoubt) return {NAN, 0.0};
  if (std::abs(std::abs(whole + here.winding) - source_.threshold) < 2.0 * allowed_)
    here = source_.rims.at(p, direction);
  return {whole + here.winding, std::min(there.clearance, here.clearance)};
}

/// Computes a number from one of the samples around the point, or at last from the lattice's first, which
/// lies outside.
double PointWinding::exactNumber(const WindingPoints& points, size_t i) {
  const glm::vec3& p = points.cells[i];
  const int size = std::max({dims_.x, dims_.y, dims_.z});
  if (glm::length(p) > kOutOfSight * static_cast<float>(size)) return 0.0;
  const auto first = uint32_t(source_.lattice.grid.index(lowestCorner(p)));
  RimShare best{source_.lattice.winding[nearestSample(p)], 0.0};
  for (uint32_t c = 0; c <= kCorners && best.clearance < kSafeClearance; ++c) {
    const RimShare number = numberFrom(c < kCorners ? first + offsets_[c] : 0, points, i);
    if (number.clearance > best.clearance) best = number;
  }
  return best.winding;
}

void PointWinding::compute(const WindingPoints& points, std::span<double> winding) {
  isClose_ = false;
  allowed_ = kSideError;
  const bool isWhole = source_.lattice.isWhole();
  asked_.clear();
  crossing_.clear();
  doubt_.assign(points.cells.size(), 0.0f);
  for (uint32_t i = 0; i < points.cells.size(); ++i) {
    const glm::vec3& p = points.cells[i];
    const bool isBeyond = isOutside(p);
    winding[i] = isBeyond && isWhole ? 0.0 : NAN;
    if (isBeyond || isNearRim(p)) continue;
    const Reference reference = findReference(p, points.distance[i]);
    if (reference.sample == Reference::kNone) continue;
    doubt_[i] = doubtFrom(p, source_.lattice.distance[reference.sample]);
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
  for (uint32_t i = 0; i < points.cells.size(); ++i)
    if (std::isnan(winding[i]) || !isSettled(winding[i], doubt_[i])) {
      asked_.push_back(i);
      doubt_[i] = INFINITY;
    }
  settle(points, winding);
}

double PointWinding::doubtOf(size_t point) const {
  return source_.lattice.isWhole() ? 0.0 : doubt_[point];
}

void PointWinding::computeClosely(const WindingPoints& points, std::span<double> winding, double allowed) {
  if (source_.lattice.isWhole()) {
    compute(points, winding);
    return;
  }
  asked_.resize(points.cells.size());
  std::iota(asked_.begin(), asked_.end(), 0u);
  isClose_ = true;
  allowed_ = allowed;
  settle(points, winding);
}

/// Computes the numbers of the points in `asked_`: from faces and rims, or with many rims by dipoles, unless
/// these leave a side in doubt.
void PointWinding::settle(const WindingPoints& points, std::span<double> winding) {
  const size_t rims = source_.rims.count();
  if (isClose_ ? rims > 0 && rims <= kExactRims : !source_.dipoles.isPrepared()) {
    for (const uint32_t i : asked_) winding[i] = exactNumber(points, i);
    return;
  }
  ends_.clear();
  for (const uint32_t i : asked_) ends_.push_back(points.cells[i]);
  numbers_.resize(asked_.size());
  const uint32_t first = isClose_ ? 1 : 0, end = rims > 0 ? kLooks - 1 : kLooks;
  source_.dipoles.settleAt(source_.tree, ends_, source_.threshold, {first, end}, numbers_);
  for (size_t k = 0; k < asked_.size(); ++k) {
    const uint32_t i = asked_[k];
    const double gap = std::abs(std::abs(numbers_[k]) - source_.threshold);
    const bool isDoubtful = gap < kClose[end - 1] || points.distance[i] <= slack_;
    winding[i] = !isDoubtful ? numbers_[k]
                 : rims > 0  ? exactNumber(points, i)
                             : sideOf(points, i, numbers_[k]);
  }
}

/// Single precision cannot tell some points from the surface. Away from rims, crossings tell their side of
/// it.
double PointWinding::sideOf(const WindingPoints& points, size_t i, double winding) {
  const glm::vec3& p = points.cells[i];
  if (points.distance[i] > slack_ || isOutside(p) || isNearRim(p)) return winding;
  const double crossed = exactNumber(points, i);
  return isSettled(crossed, doubtFrom(p, 0.0f)) ? winding + std::round(crossed - winding) : winding;
}

}  // namespace raymap::cpu
