#include "mesh/pieces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "mesh/part_volumes.h"
#include "predicates/line_triangle.h"

namespace raymap {

namespace {

constexpr size_t kFacesPerCast = size_t{1} << 13;
constexpr double kTouching = 1e-10;  // Distance from the start of a ray, as a share of the mesh's size.

/// A ray along x.
struct Ray {
  glm::dvec3 start;
  uint32_t piece;
};

/// Rays in the cells of a lattice across x.
class RayLattice {
 public:
  RayLattice(std::vector<Ray> rays, const Box& box) : rays_(std::move(rays)), low_(box.min) {
    side_ = std::max(1, int(std::sqrt(double(rays_.size()))));
    const glm::dvec3 size = box.size();
    scale_ = {1.0, size.y > 0.0 ? side_ / size.y : 0.0, size.z > 0.0 ? side_ / size.z : 0.0};
    std::ranges::stable_sort(rays_, {}, [&](const Ray& ray) { return cellOf(ray.start); });
    starts_.resize(size_t(side_) * size_t(side_) + 1);
    for (const Ray& ray : rays_) ++starts_[cellOf(ray.start) + 1];
    for (size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
  }

  const std::vector<Ray>& rays() const { return rays_; }

  /// Visits the indices of all rays that may cross a triangle.
  template <class Visit>
  void forEachNear(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, Visit&& visit) const {
    const glm::ivec2 low = placeOf(glm::min(glm::min(a, b), c)), high = placeOf(glm::max(glm::max(a, b), c));
    for (int z = low.y; z <= high.y; ++z) {
      const size_t row = size_t(z) * size_t(side_);
      for (size_t r = starts_[row + size_t(low.x)]; r < starts_[row + size_t(high.x) + 1]; ++r)
        visit(uint32_t(r));
    }
  }

 private:
  glm::ivec2 placeOf(const glm::dvec3& p) const {
    const glm::dvec3 place = (p - low_) * scale_;
    return {std::clamp(int(place.y), 0, side_ - 1), std::clamp(int(place.z), 0, side_ - 1)};
  }
  size_t cellOf(const glm::dvec3& p) const {
    const glm::ivec2 place = placeOf(p);
    return size_t(place.y) * size_t(side_) + size_t(place.x);
  }

  std::vector<Ray> rays_;  // In the order of their cells.
  glm::dvec3 low_, scale_;
  int side_;
  std::vector<size_t> starts_;
};

/// Pieces that rays cross an odd number of times enclose the rays' starts.
class Nesting {
 public:
  Nesting(const PackedMesh& mesh, Pieces& found, size_t raysPerPiece)
      : mesh_(mesh), found_(found), lattice_(startRays(raysPerPiece), localBox()) {
    const glm::dvec3 size = localBox().size();
    touching_ = kTouching * std::max({size.x, size.y, size.z});
  }

  void find() {
    std::vector<Crossings> tasks((mesh_.triangles.size() + kFacesPerCast - 1) / kFacesPerCast);
    parallelFor(tasks.size(), 1, [&](size_t task, size_t) {
      const size_t begin = task * kFacesPerCast;
      castAt(begin, std::min(begin + kFacesPerCast, mesh_.triangles.size()), tasks[task]);
    });
    std::vector<uint64_t> crossed;
    std::vector<bool> isTouching(lattice_.rays().size());
    for (const Crossings& task : tasks) {
      crossed.insert(crossed.end(), task.keys.begin(), task.keys.end());
      for (const uint32_t ray : task.touching) isTouching[ray] = true;
    }
    found_.areTouching = std::ranges::find(isTouching, true) != isTouching.end();
    parallelSort(crossed.begin(), crossed.end());
    judge(crossed, isTouching);
  }

 private:
  struct Crossings {
    std::vector<uint64_t> keys;      // Each holds a ray, then a piece.
    std::vector<uint32_t> touching;  // Rays that start on another piece.
  };

  Box localBox() const {
    const Box box = bounds(mesh_);
    return {box.min - mesh_.origin, box.max - mesh_.origin};
  }

  std::vector<Ray> startRays(size_t raysPerPiece) const {
    std::vector<size_t> faces(found_.pieces.size()), seen(found_.pieces.size());
    for (const uint32_t piece : found_.ids) ++faces[piece];
    std::vector<Ray> rays;
    for (size_t f = 0; f < found_.ids.size(); ++f) {
      const uint32_t piece = found_.ids[f];
      const size_t step = (faces[piece] + raysPerPiece - 1) / raysPerPiece;
      if (seen[piece]++ % step != 0) continue;
      const auto [a, b, c] = mesh_.corners(mesh_.triangles[f]);
      rays.push_back({(a + b + c) / 3.0, piece});
    }
    return rays;
  }

  void castAt(size_t begin, size_t end, Crossings& crossings) const {
    for (size_t f = begin; f < end; ++f) {
      const std::array<glm::dvec3, 3> p = mesh_.corners(mesh_.triangles[f]);
      lattice_.forEachNear(p[0], p[1], p[2], [&](uint32_t r) {
        const Ray& ray = lattice_.rays()[r];
        if (ray.piece == found_.ids[f]) return;
        const std::optional<double> x = crossingAt(p[0], p[1], p[2], ray.start.y, ray.start.z);
        if (!x) return;
        if (std::abs(*x - ray.start.x) <= touching_) crossings.touching.push_back(r);
        if (*x > ray.start.x) crossings.keys.push_back(uint64_t{r} << 32 | found_.ids[f]);
      });
    }
  }

  /// Keeps, for each piece, what encloses the start of its first ray that touches no other piece.
  void judge(const std::vector<uint64_t>& crossed, const std::vector<bool>& isTouching) {
    std::vector<std::optional<std::vector<uint32_t>>> enclosing(found_.pieces.size());
    size_t at = 0;
    for (uint32_t r = 0; r < lattice_.rays().size(); ++r) {
      std::vector<uint32_t> around;
      while (at < crossed.size() && crossed[at] >> 32 == r) {
        const size_t first = at;
        while (at < crossed.size() && crossed[at] == crossed[first]) ++at;
        if ((at - first) % 2 == 1) around.push_back(uint32_t(crossed[first]));
      }
      if (isTouching[r]) continue;
      std::optional<std::vector<uint32_t>>& known = enclosing[lattice_.rays()[r].piece];
      if (known && *known != around) found_.areMixed = true;
      if (!known) known = std::move(around);
    }
    for (size_t p = 0; p < found_.pieces.size(); ++p)
      for (const uint32_t other : enclosing[p].value_or(std::vector<uint32_t>{})) {
        uint32_t& around = found_.pieces[p].around;
        const auto size = [&](uint32_t piece) { return std::abs(found_.pieces[piece].volume); };
        if (around == Piece::kNone || size(other) < size(around)) around = other;
      }
  }

  const PackedMesh& mesh_;
  Pieces& found_;
  RayLattice lattice_;
  double touching_;
};

}  // namespace

Pieces findPieces(const Model& mesh) {
  Patches patches = findPatches(mesh);
  Pieces found{.ids = std::move(patches.ids), .pieces = std::vector<Piece>(patches.count)};
  const std::vector<double> volumes = partVolumes(mesh, found.ids, patches.count);
  for (size_t p = 0; p < volumes.size(); ++p) found.pieces[p].volume = volumes[p];
  return found;
}

void nestPieces(const PackedMesh& mesh, size_t raysPerPiece, Pieces& found) {
  if (found.pieces.size() > 1) Nesting(mesh, found, raysPerPiece).find();
}

}  // namespace raymap
