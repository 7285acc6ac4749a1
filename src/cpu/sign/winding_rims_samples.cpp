// Martens, Trettner & Bessmeltsev 2026, "The Antipodal Method", where Krayer & Müller 2019, §3.5, average
// curves: the ray map has the first term, the crossings of a ray from each sample.

#include "cpu/sign/winding_rims_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "cpu/sign/winding_harmonic_transfer.h"
#include "cpu/sign/winding_rims.h"

namespace raymap::cpu {

namespace {

constexpr size_t kSamplesPerTask = 64;
/// Any error is allowed along a ray that passes rims closely. Else it is below 2e-6.
constexpr double kAllowedToTry = std::numeric_limits<double>::infinity();

class SampleNumbers {
 public:
  SampleNumbers(const RayMap& map, const RimLattices& lattices)
      : map_(map), centre_(lattices.centre), rims_(lattices.rims) {}

  /// Returns the winding number of a sample, which may lie outside of the grid.
  float at(const glm::ivec3& sample) const {
    const glm::dvec3 p(sample);
    uint32_t ray = 0;
    RimShare best{.clearance = 0.0};
    for (uint32_t i = 0; i < 6 && best.clearance < double(kClearOfRims); ++i) {
      const uint32_t next = rayToTry(i, glm::vec3(sample) - centre_);
      const RimShare share = rims_.at(p, direction(next), kAllowedToTry);
      if (share.clearance > best.clearance) ray = next, best = share;
    }
    if (best.clearance < double(kClearOfRims)) best = rims_.at(p, direction(ray));
    if (best.clearance >= double(kShareInDoubles * kLeastClearance))
      return rounded(crossings(sample, ray) + best.winding);
    const glm::dvec3 displacement(kDisplacement[0], kDisplacement[1], kDisplacement[2]);
    best = rims_.at(p + double(kShareInDoubles) * displacement, direction(0));
    return rounded(crossings(sample, 0) + best.winding);
  }

 private:
  static glm::dvec3 direction(uint32_t ray) {
    glm::dvec3 d(0.0);
    d[int(ray % 3)] = ray < 3 ? 1.0 : -1.0;
    return d;
  }

  static float rounded(double winding) {
    return static_cast<float>(std::round(winding * double(kRimUnits)) / double(kRimUnits));
  }

  double crossings(glm::ivec3 sample, uint32_t ray) const {
    const int axis = int(ray % 3);
    const int32_t after = map_.ray(axis, sample);
    if (ray < 3) return after;
    sample[axis] = -1;
    return after - map_.ray(axis, sample);
  }

  const RayMap& map_;
  glm::vec3 centre_;
  WindingRims rims_;
};

LatticeBox rimBox(const glm::ivec3& dims, int level) {
  return {.level = level, .low = glm::ivec3(0), .dims = rimDims(dims, uint32_t(level))};
}

void computeSamples(const SampleNumbers& numbers, const LatticeBox& box, std::span<const uint32_t> places,
                    WorkMeter& meter, float* values) {
  const auto width = uint32_t(box.dims.x), height = uint32_t(box.dims.y);
  parallelFor(places.size(), kSamplesPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t place = places[i], row = place / width;
      values[place] = numbers.at(glm::ivec3(place % width, row % height, row / height) << box.level);
    }
    meter.add(end - begin);
  });
}

}  // namespace

void computeFromRims(const RayMap& map, const RimLattices& lattices, Progress& progress, double begin,
                     HarmonicScratch& scratch, Buffer<float>& winding) {
  const SampleNumbers numbers(map, lattices);
  const size_t count = lattices.computed.size();
  double total = 0.0;
  for (size_t l = 0; l < count; ++l)
    total += double(lattices.computed[l].size()) + double(rimBox(map.dims, int(l)).sampleCount());
  WorkMeter meter(progress, begin, 1.0, total);
  scratch.levels.resize(std::max(scratch.levels.size(), count));
  for (size_t l = count; l-- > 0;) {
    HarmonicLevel& level = scratch.levels[l];
    level.box = rimBox(map.dims, int(l));
    if (l > 0) level.values.resizeUninitialized(level.box.sampleCount());
    float* values = l == 0 ? winding.data() : level.values.data();
    if (l + 1 < count) {
      const HarmonicLevel& coarse = scratch.levels[l + 1];
      for (int axis = 0; axis < 3; ++axis) level.jumps[size_t(axis)].collect(map, level.box, axis);
      prolongField(coarse.box, coarse.values.data(), level.box, level.jumps, meter, values);
    }
    computeSamples(numbers, level.box, lattices.computed[l], meter, values);
  }
}

size_t bytesForRims(const RayMap& map) {
  size_t sum = 0;
  const int coarsest = coarsestRimLevel(map.dims);
  for (int l = 0; l <= coarsest; ++l) {
    const LatticeBox box = rimBox(map.dims, l);
    if (l > 0) sum += sizeof(float) * box.sampleCount();
    if (l == coarsest) break;
    for (const RayMap::Axis& axis : map.axes) sum += JumpRows::bytesNeeded(box, axis.steps.size());
  }
  return sum;
}

void settleByRims(const RayMap& map, const RimLattices& lattices, std::span<const uint32_t> samples,
                  Progress& progress, Buffer<float>& winding) {
  if (samples.empty()) return;
  WorkMeter meter(progress, 0.0, 1.0, double(samples.size()));
  computeSamples({map, lattices}, rimBox(map.dims, 0), samples, meter, winding.data());
}

}  // namespace raymap::cpu
