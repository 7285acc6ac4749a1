// Ours: parts of a mesh that are thinner than a solid should be.
//
// A plate of thickness T takes the place of a thin part. It surrounds the middle of the part, so a wall of
// thickness t grows by (T - t) / 2 to each side, and what is thicker than T stays as it is.

#include "repair/solid/thin_parts.h"

#include <raymap/thickness.h>

#include <algorithm>

#include "base/parallel.h"
#include "cpu/points/local_thickness.h"
#include "field/field_sampler.h"
#include "mesh/face_points.h"

namespace raymap {

namespace {

constexpr double kLongestSide = 1.0;  // Longest side of the parts of faces, in samples.
constexpr double kBand = 3.0;         // Samples around the plates that the isosurface may read.

/// Finds the thin parts of a mesh, and makes the surface in their middle.
class ThinParts {
 public:
  /// `limit` is the thickness below which the mesh is thin.
  ThinParts(const Field& solid, double offset, double limit)
      : solid_(solid), sampler_(solid), offset_(offset), limit_(limit) {}

  void find(const cpu::PreparedSurface& surface, Progress& progress) {
    const double step = kLongestSide * solid_.grid.spacing;
    const PackedMesh& mesh = surface.mesh;
    points_ = sampleFaces(mesh, step);
    thickness_.resize(points_.size());
    cpu::measureThickness(surface, points_, limit_, progress, thickness_);
    findOpenParts(surface, progress);
    middle_.origin = mesh.origin;
    size_t next = 0;
    for (const glm::uvec3& t : mesh.triangles)
      forEachFacePart(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z], step,
                      [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
                        const double area = points_[next].area;
                        const Thickness& found = thickness_[next++];
                        area_ += area;
                        if (!isThin(found)) return;
                        thinArea_ += area;
                        add(0.5f * found.diameter * found.inward, a, b, c);
                      });
  }

  /// Returns the middle between the two sides of each thin part.
  const Mesh& middle() const { return middle_; }
  /// Returns the share of the mesh's area that is thin.
  double share() const { return area_ > 0.0 ? thinArea_ / area_ : 0.0; }

 private:
  bool isThin(const Thickness& found) const {
    if (found.part == Part::Sheet) return true;
    return (found.part == Part::Wall || found.part == Part::Edge) && double(found.diameter) < limit_;
  }

  /// Treats a part as a sheet if the solid behind it ends where there is no face, such as under a shallow
  /// bowl. The samples tell where it does not.
  void findOpenParts(const cpu::PreparedSurface& surface, Progress& progress) {
    const Grid& grid = solid_.grid;
    std::vector<size_t> asked;
    std::vector<glm::dvec3> places;
    for (size_t i = 0; i < points_.size(); ++i) {
      if (thickness_[i].part != Part::Solid) continue;
      const glm::dvec3 p = points_[i].position + 0.5 * limit_ * glm::dvec3(thickness_[i].inward);
      if (sampler_.value((p - grid.origin) / grid.spacing) * grid.spacing + offset_ < 0.0) continue;
      asked.push_back(i);
      places.push_back(p);
    }
    QueryResult found;
    cpu::queryPoints(surface, places, {}, progress, found);
    for (size_t k = 0; k < asked.size(); ++k)
      if (found.distance[k] >= 0.0) thickness_[asked[k]] = {Part::Sheet, 0.0f, glm::vec3(0.0f)};
  }

  void add(const glm::vec3& move, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<uint32_t>(middle_.vertices.size());
    middle_.vertices.insert(middle_.vertices.end(), {a + move, b + move, c + move});
    middle_.triangles.emplace_back(first, first + 1, first + 2);
  }

  const Field& solid_;
  FieldSampler sampler_;
  double offset_, limit_;
  std::vector<FacePoint> points_;
  std::vector<Thickness> thickness_;
  Mesh middle_;
  double area_ = 0.0, thinArea_ = 0.0;
};

/// Unites a solid with all points that are less than half of `thickness` from a surface.
void uniteWithPlates(const Mesh& middle, double thickness, Given& given, Field& solid) {
  const Field plates =
      given.generateOther(middle, {.sign = SignMode::None, .band = kBand, .thickness = thickness});
  const auto far = static_cast<float>(kBand * solid.grid.spacing);
  parallelFor(solid.distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (plates.distance[i] < far) solid.distance[i] = std::min(solid.distance[i], plates.distance[i]);
  });
}

}  // namespace

double thickenThinParts(Given& given, Field& solid, Progress& progress) {
  const RepairOptions& repair = given.repair;
  // The offset moves both sides.
  const double limit = repair.minThickness - 2.0 * repair.offset;
  if (limit <= 0.0) return 0.0;
  ThinParts parts(solid, repair.offset, limit);
  parts.find(given.surface(), progress);
  if (!parts.middle().triangles.empty()) uniteWithPlates(parts.middle(), repair.minThickness, given, solid);
  return parts.share();
}

}  // namespace raymap
