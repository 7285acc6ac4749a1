// Ours: parts of a mesh that are thinner than a solid should be.
//
// A plate of thickness T takes the place of a thin part. It surrounds the middle of the part, so a wall of
// thickness t grows by (T - t) / 2 to each side, and what is thicker than T stays as it is.
//
// Only points where no ball of diameter T fits into the field can be thin. Most points of a body are not, and
// are not measured.

#include <raymap/mesh_thickness.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "base/text.h"
#include "cpu/points/local_thickness.h"
#include "mesh/face_measures.h"
#include "mesh/face_points.h"
#include "mesh/triangle.h"
#include "repair/solid/solid_band.h"
#include "repair/stages.h"

namespace raymap {

namespace {

constexpr double kLongestSide = 1.0;  // Longest side of the parts of faces, in samples.
constexpr double kBand = 3.0;         // Samples around the plates that the isosurface may read.
constexpr double kSlack = 0.05;  // What interpolation may lack of the depth of a ball that fits, in samples.
// Farthest sample inside from a point that the isosurface shows, in samples. No samples reach into corners.
constexpr double kSeen = 1.5;
// Largest value of the field at a point of a sheet that the isosurface passes, in samples.
constexpr double kPassed = 0.15;
constexpr double kNotableGrowth = 1e-3;  // A smaller share of the mesh's area needs no warning.

/// Walls that became thicker. Shares are of the mesh's area.
struct Thickened {
  double share = 0.0;       ///< Share on plates.
  double grownShare = 0.0;  ///< Share on walls that became more than twice as thick.
  double thinnest = 0.0;    ///< Thickness that a hundredth of these walls does not exceed.
  double median = 0.0;      ///< Thickness that half of them does not exceed.
};

/// Finds the thin parts of a mesh, and the surface in their middle.
class ThinParts {
 public:
  ThinParts(const Field& solid, const RepairOptions& repair)
      : solid_(solid),
        sampler_(solid),
        offset_(repair.offset),
        least_(leastThickness(repair, solid.grid)),
        isAsked_(repair.minThickness.has_value()) {}

  /// Measures the mesh where it may be thin.
  void measure(const cpu::PreparedSurface& surface, Progress& progress) {
    findDoubtful(surface.mesh);
    thickness_.resize(doubtful_.size());
    cpu::measureThickness(surface, doubtful_, limit(), progress, thickness_);
    findOpenParts(surface, progress);
  }

  /// Returns the surface in the middle of thin walls and edges, and sheets.
  Mesh middleOfThin(const PackedMesh& mesh) {
    return middleOf(mesh.origin, [&](size_t i) { return isThin(thickness_[i]); });
  }
  /// Returns the surface that the field shows nowhere near. It may have plates by now.
  Mesh missed(const PackedMesh& mesh) {
    const SolidSampler sampler(solid_);  // Plates move the samples in memory.
    return middleOf(mesh.origin, [&](size_t i) { return isMissed(sampler, doubtful_[i], thickness_[i]); });
  }

  /// Returns what became thicker, after the surfaces above were returned.
  Thickened thickened() const {
    if (area_ == 0.0) return {};
    std::vector<std::pair<double, double>> walls;  // Thickness with the offset, and area.
    double area = 0.0;
    for (size_t i = 0; i < doubtful_.size(); ++i) {
      const double own = double(thickness_[i].diameter) + 2.0 * offset_;
      if (isCounted_[i] == 0 || thickness_[i].part != Part::Wall || own <= 0.0 || 2.0 * own >= least_)
        continue;
      walls.emplace_back(own, doubtful_[i].area);
      area += doubtful_[i].area;
    }
    std::ranges::sort(walls);
    const auto quantile = [&](double share) {
      double sum = 0.0;
      for (const auto& [own, part] : walls)
        if ((sum += part) >= share * area) return own;
      return 0.0;
    };
    return {thinArea_ / area_, area / area_, quantile(0.01), quantile(0.5)};
  }
  /// Returns the thickness below which the mesh is thin. The offset moves both sides.
  double limit() const { return least_ - 2.0 * offset_; }

 private:
  using Corners = std::array<glm::vec3, 3>;

  /// Parts of some faces that may be thin, and the area of all parts.
  struct DoubtfulParts {
    std::vector<FacePoint> points = {};
    std::vector<Corners> corners = {};
    double area = 0.0;
  };

  /// Returns the middle of the doubtful parts that `isWanted` names by their numbers.
  template <class IsWanted>
  Mesh middleOf(const glm::dvec3& origin, IsWanted&& isWanted) {
    Mesh middle;
    middle.origin = origin;
    for (size_t i = 0; i < doubtful_.size(); ++i) {
      if (!isWanted(i)) continue;
      if (!isCounted_[i]) thinArea_ += doubtful_[i].area;
      isCounted_[i] = 1;
      const glm::vec3 move =
          isThick(thickness_[i]) ? glm::vec3(0.0f) : 0.5f * thickness_[i].diameter * thickness_[i].inward;
      const auto first = static_cast<uint32_t>(middle.vertices.size());
      for (const glm::vec3& corner : corners_[i]) middle.vertices.push_back(corner + move);
      middle.triangles.emplace_back(first, first + 1, first + 2);
    }
    return middle;
  }

  bool isThick(const Thickness& found) const { return double(found.diameter) >= limit(); }

  /// If no least thickness was asked for, what the offset takes away does not come back, and sheets are thin
  /// only where they are missed: the rims of holes are sheets that the solid shows well enough.
  bool isThin(const Thickness& found) const {
    if (found.part == Part::Sheet) return isAsked_;
    if (!isAsked_ && double(found.diameter) + 2.0 * offset_ < 0.0) return false;
    return (found.part == Part::Wall || found.part == Part::Edge) && !isThick(found);
  }

  /// Returns whether the isosurface does not show a point of the mesh: nothing is inside near it, such as at
  /// a rod of three sides, or the field only touches zero at a sheet.
  bool isMissed(const SolidSampler& sampler, const FacePoint& point, const Thickness& found) const {
    if (offset_ < 0.0 || found.part == Part::Buried) return false;
    const glm::dvec3 at = (point.position - solid_.grid.origin) / solid_.grid.spacing;
    return !isSeen(at) || (found.part == Part::Sheet && sampler.value(at) > kPassed);
  }

  bool isSeen(const glm::dvec3& at) const {
    const Grid& grid = solid_.grid;
    const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(at - kSeen)), 0);
    const glm::ivec3 high = glm::min(glm::ivec3(glm::floor(at + kSeen)), grid.dims - 1);
    for (int k = low.z; k <= high.z; ++k)
      for (int j = low.y; j <= high.y; ++j)
        for (int i = low.x; i <= high.x; ++i)
          if (glm::distance(at, glm::dvec3(i, j, k)) <= kSeen && solid_.distanceAt({i, j, k}) < 0.0f)
            return true;
    return false;
  }

  /// Returns whether no ball of the plate's diameter fits into the solid on either side of a point.
  bool isDoubtful(const glm::dvec3& point, const glm::dvec3& normal) const {
    const Grid& grid = solid_.grid;
    const glm::dvec3 at = (point - grid.origin) / grid.spacing, way = 0.5 * limit() / grid.spacing * normal;
    const double deepest = -0.5 * least_ / grid.spacing + kSlack;
    return sampler_.value(at + way) > deepest && sampler_.value(at - way) > deepest;
  }

  /// Cuts a face into parts, and lists those that may be thin. Leaves out faces without an area: others lie
  /// beside them.
  void addParts(const PackedMesh& mesh, uint32_t face, DoubtfulParts& parts) const {
    const glm::uvec3& t = mesh.triangles[face];
    const auto corners = mesh.corners(t);
    if (isFlat(corners)) return;
    const glm::dvec3 normal = unitNormal(corners[0], corners[1], corners[2]);
    forEachFacePart(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z],
                    kLongestSide * solid_.grid.spacing,
                    [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
                      const double area = triangleArea(a, b, c);
                      parts.area += area;
                      const glm::dvec3 middle = (glm::dvec3(a) + glm::dvec3(b) + glm::dvec3(c)) / 3.0;
                      if (!isDoubtful(mesh.origin + middle, normal)) return;
                      parts.points.push_back({mesh.origin + middle, face, area});
                      parts.corners.push_back({a, b, c});
                    });
  }

  void findDoubtful(const PackedMesh& mesh) {
    constexpr size_t kFacesPerTask = 256;
    const size_t count = mesh.triangles.size();
    std::vector<DoubtfulParts> tasks((count + kFacesPerTask - 1) / kFacesPerTask);
    parallelFor(tasks.size(), 1, [&](size_t task, size_t) {
      const size_t end = std::min(count, (task + 1) * kFacesPerTask);
      for (size_t face = task * kFacesPerTask; face < end; ++face)
        addParts(mesh, uint32_t(face), tasks[task]);
    });
    for (const DoubtfulParts& task : tasks) {
      area_ += task.area;
      doubtful_.insert(doubtful_.end(), task.points.begin(), task.points.end());
      corners_.insert(corners_.end(), task.corners.begin(), task.corners.end());
    }
    isCounted_.assign(doubtful_.size(), 0);
  }

  /// Treats a part as a sheet if the solid behind it ends where there is no face, such as under a shallow
  /// bowl. The samples tell where it does not.
  void findOpenParts(const cpu::PreparedSurface& surface, Progress& progress) {
    const Grid& grid = solid_.grid;
    std::vector<size_t> asked;
    std::vector<glm::dvec3> places;
    for (size_t i = 0; i < doubtful_.size(); ++i) {
      if (thickness_[i].part != Part::Solid) continue;
      const glm::dvec3 p = doubtful_[i].position + 0.5 * limit() * glm::dvec3(thickness_[i].inward);
      if (sampler_.value((p - grid.origin) / grid.spacing) * grid.spacing + offset_ < 0.0) continue;
      asked.push_back(i);
      places.push_back(p);
    }
    QueryResult found;
    cpu::queryPoints(surface, places, {}, progress, found);
    for (size_t k = 0; k < asked.size(); ++k)
      if (found.distance[k] >= 0.0) thickness_[asked[k]] = {Part::Sheet, 0.0f, glm::vec3(0.0f)};
  }

  const Field& solid_;
  SolidSampler sampler_;  // Of the solid without plates.
  double offset_, least_;
  bool isAsked_;
  std::vector<FacePoint> doubtful_;  // Middles of parts of faces that may be thin,
  std::vector<Corners> corners_;     // and the corners of these parts.
  std::vector<uint8_t> isCounted_;   // Whether the area of each is in the thin one already.
  std::vector<Thickness> thickness_;
  double area_ = 0.0, thinArea_ = 0.0;
};

/// Unites a solid with all points that are less than half of `thickness` from a surface.
void uniteWithPlates(const Mesh& middle, double thickness, RepairRun& run) {
  Field& solid = run.solid;
  if (middle.triangles.empty()) return;
  if (solid.narrow) {
    const double width = kBand * solid.grid.spacing;
    return unite(solid, makePlateBand(middle, solid.grid, 0.5 * thickness, width, run.most(), run.progress));
  }
  const Field plates = run.fieldOf(middle, {.sign = SignMode::None, .band = kBand, .thickness = thickness});
  const auto far = static_cast<float>(kBand * solid.grid.spacing);
  parallelFor(solid.distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (plates.distance[i] < far) solid.distance[i] = std::min(solid.distance[i], plates.distance[i]);
  });
}

/// Warns of walls that became more than twice as thick, unless a least thickness was asked for.
void warnOfThickened(const Thickened& thickened, const RepairRun& run) {
  const double share = run.fieldShare() * thickened.grownShare;
  if (run.options.minThickness || share < kNotableGrowth) return;
  const double voxelSize = roundDown(0.5 * thickened.thinnest);
  const double count = surfaceCubes(run.mesh(), voxelSize);
  const bool isPossible = count <= kMostAdvisedCubes;
  run.machine.warn(
      {WarningCode::PartsThickened,
       numberText(100.0 * share, 3) + " % of the mesh's surface is on walls about " +
           numberText(thickened.median, 3) + " thick, which are " + numberText(run.report.leastThickness, 3) +
           " thick now; a voxel size of " + numberText(voxelSize, 3) + " keeps them, with " +
           numberText(count, 2) + " cubes of samples at the surface" +
           (isPossible ? "" : ", which is too many: repair parts of the mesh apart from each other"),
       {.share = share, .length = run.report.leastThickness, .voxelSize = isPossible ? voxelSize : 0.0}});
}

}  // namespace

double leastThickness(const RepairOptions& repair, const Grid& grid) {
  return repair.minThickness.value_or(kThinnestWall * grid.spacing);
}

void thickenThinParts(RepairRun& run) {
  ThinParts parts(run.solid, run.options);
  if (parts.limit() <= 0.0) return;
  parts.measure(run.surface(), run.progress);
  uniteWithPlates(parts.middleOfThin(run.mesh()), run.report.leastThickness, run);
  uniteWithPlates(parts.missed(run.mesh()), run.report.leastThickness, run);
  const Thickened thickened = parts.thickened();
  run.report.thickenedShare += run.fieldShare() * thickened.share;
  warnOfThickened(thickened, run);
}

}  // namespace raymap
