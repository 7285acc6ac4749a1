#include "method/winding_rims_lattices.h"

#include <algorithm>
#include <bit>
#include <cfloat>

#include "base/parallel.h"
#include "method/winding_harmonic_lattices.h"

namespace raymap {

namespace {

/// Coarsest lattice: every eighth sample. Finer ones have more samples to compute, coarser ones more rims
/// near them.
constexpr int kCoarsestLevel = 3;
/// Most rims that all computed samples together may see, for each sample of the grid. So many take as long as
/// the fit.
constexpr double kMostRimsPerSample = 8.0;
/// With more rims, a look at the dipoles is faster.
constexpr size_t kFewRims = 1536;
/// With more rims, all looks at the dipoles are faster.
constexpr size_t kManyRims = 4096;
/// With more rims, dipoles decide alone: a number takes about a millisecond from so many.
constexpr size_t kMostRims = size_t{1} << 18;

bool isInside(const PackedMesh& mesh, const Grid& grid) {
  const Box box = bounds(mesh);
  const glm::dvec3 low = (box.min - grid.origin) / grid.spacing,
                   high = (box.max - grid.origin) / grid.spacing;
  return glm::all(glm::greaterThan(low, glm::dvec3(-1.0))) &&
         glm::all(glm::lessThan(high, glm::dvec3(grid.dims)));
}

/// Samples of a lattice, one bit each.
class Marks {
 public:
  explicit Marks(const glm::ivec3& dims) : dims_(dims), words_((count() + 63) / 64) {}

  /// Marks the samples within one and a half cells of an edge, and some within two. The edge is in the
  /// lattice's cells.
  void markAround(const glm::vec3& a, const glm::vec3& b) {
    const int steps = 1 + static_cast<int>(2.0f * glm::distance(a, b));
    glm::ivec3 last(INT32_MIN);
    for (int s = 0; s <= steps; ++s) {
      const glm::ivec3 cell(glm::floor(a + (b - a) * (static_cast<float>(s) / static_cast<float>(steps))));
      if (cell != last) markCube(cell - 1, cell + 2);
      last = cell;
    }
  }

  std::vector<uint32_t> list() const {
    std::vector<uint32_t> places;
    for (size_t w = 0; w < words_.size(); ++w)
      for (uint64_t word = words_[w]; word != 0; word &= word - 1)
        places.push_back(static_cast<uint32_t>(64 * w + static_cast<size_t>(std::countr_zero(word))));
    return places;
  }

 private:
  size_t count() const { return size_t(dims_.x) * size_t(dims_.y) * size_t(dims_.z); }

  void markCube(const glm::ivec3& low, const glm::ivec3& high) {
    const glm::ivec3 first = glm::max(low, 0), last = glm::min(high, dims_ - 1);
    for (int k = first.z; k <= last.z; ++k)
      for (int j = first.y; j <= last.y; ++j)
        for (int i = first.x; i <= last.x; ++i) {
          const size_t place = (size_t(k) * dims_.y + j) * dims_.x + i;
          words_[place / 64] |= uint64_t{1} << place % 64;
        }
  }

  glm::ivec3 dims_;
  std::vector<uint64_t> words_;
};

std::vector<uint32_t> samplesNear(const std::vector<RimLine>& rims, const glm::ivec3& dims, int level) {
  Marks marks(rimDims(dims, uint32_t(level)));
  const float scale = 1.0f / static_cast<float>(1 << level);
  for (const RimLine& rim : rims) marks.markAround(scale * rim.from, scale * rim.to);
  return marks.list();
}

std::vector<uint32_t> allSamples(const glm::ivec3& dims, int level) {
  const glm::ivec3 size = rimDims(dims, uint32_t(level));
  std::vector<uint32_t> places(size_t(size.x) * size_t(size.y) * size_t(size.z));
  for (size_t i = 0; i < places.size(); ++i) places[i] = static_cast<uint32_t>(i);
  return places;
}

std::vector<RimLine> inCells(const PackedMesh& mesh, const Grid& grid, std::span<const RimEdge> edges) {
  const glm::dvec3 shift = mesh.origin - grid.origin;
  const double scale = 1.0 / grid.spacing;
  const auto place = [&](uint32_t v) { return glm::vec3((shift + glm::dvec3(mesh.vertices[v])) * scale); };
  std::vector<RimLine> rims;
  for (const RimEdge& edge : edges)
    rims.insert(rims.end(), edge.times, RimLine{place(edge.from), place(edge.to)});
  return rims;
}

glm::vec3 centreOf(const std::vector<RimLine>& rims) {
  glm::vec3 low(rims.empty() ? 0.0f : FLT_MAX), high = -low;
  for (const RimLine& rim : rims) {
    low = glm::min(low, glm::min(rim.from, rim.to));
    high = glm::max(high, glm::max(rim.from, rim.to));
  }
  return 0.5f * low + 0.5f * high;
}

/// Returns the samples to be computed by level, or nothing if they see more rims than allowed.
std::vector<std::vector<uint32_t>> chooseSamples(const std::vector<RimLine>& rims, const glm::ivec3& dims,
                                                 double mostRims) {
  const int coarsest = coarsestRimLevel(dims);
  std::vector<std::vector<uint32_t>> samples(size_t(coarsest) + 1);
  samples.back() = allSamples(dims, coarsest);
  double total = double(samples.back().size()), finer = 0.0;
  for (auto level = size_t(coarsest); double(rims.size()) * (total + finer) <= mostRims;) {
    if (level-- == 0) return samples;
    samples[level] = samplesNear(rims, dims, int(level));
    const auto count = double(samples[level].size());
    total += count;
    // Curves have at least twice as many samples near them on the next finer lattice.
    finer = count * double((2u << level) - 2u);
  }
  return {};
}

}  // namespace

size_t RimLattices::bytes() const {
  size_t sum = rims.capacity() * sizeof(RimLine);
  for (const std::vector<uint32_t>& places : computed) sum += places.capacity() * sizeof(uint32_t);
  return sum;
}

int coarsestRimLevel(const glm::ivec3& dims) {
  return std::min(kCoarsestLevel, coarsestHarmonicLevel(dims));
}

RimLattices findRimLattices(const PackedMesh& mesh, const Grid& grid, SignMode mode) {
  return findRimLattices(mesh, findRimEdges(mesh, grid.spacing), grid, mode);
}

RimLattices findRimLattices(const PackedMesh& mesh, std::span<const RimEdge> edges, const Grid& grid,
                            SignMode mode) {
  size_t rimCount = 0;
  for (const RimEdge& edge : edges) rimCount += edge.times;
  RimLattices lattices;
  if (rimCount <= kMostRims || mode == SignMode::Exact) lattices.rims = inCells(mesh, grid, edges);
  lattices.centre = centreOf(lattices.rims);
  if (mode == SignMode::Exact)
    lattices.computed = {allSamples(grid.dims, 0)};
  else if (rimCount <= kManyRims && isInside(mesh, grid))
    lattices.computed =
        chooseSamples(lattices.rims, grid.dims, kMostRimsPerSample * double(grid.sampleCount()));
  if (lattices.haveAll()) return lattices;
  // The rims of a soup are more than its triangles, and dipoles look at each of these at most.
  if (rimCount > kManyRims || rimCount > mesh.triangles.size())
    lattices.looks = kLooks;
  else if (rimCount > kFewRims)
    lattices.looks = kLooks - 1;
  return lattices;
}

}  // namespace raymap
