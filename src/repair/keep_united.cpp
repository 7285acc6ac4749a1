#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/groups_apart.h"
#include "mesh/measured_parts.h"
#include "repair/stages.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/rims.h"
#include "repair/topology/settle_union.h"
#include "repair/topology/sew_cracks.h"
#include "repair/topology/unite_parts.h"
#include "simplify/face_point_lists.h"

namespace raymap {

namespace {

constexpr double kGap = 4.0;         // Samples between groups: plates and isosurfaces reach two beyond them.
constexpr double kClosedGap = 0.1;   // Between those of closed parts.
constexpr double kMostSheets = 0.5;  // Share of the area. With more, sheets may bound a solid together.

/// Parts of a mesh that are apart from all others, or may be taken so.
struct Group {
  Mesh part;
  std::vector<uint32_t> faces;  ///< Their faces in the whole mesh.
  double area = 0.0;
  UnitedParts united = {};
  bool isKept = false;

  Group(const PackedMesh& mesh, std::vector<uint32_t> numbers)
      : part(partOf(mesh, numbers)), faces(std::move(numbers)), area(sumFaces(Model(part)).area) {}

  bool isRight() const { return united.failure == FieldReason::None && !united.mesh.triangles.empty(); }
  bool isSheets() const { return isRight() && united.thickenedShare > kMostSheets; }
};

/// Makes the parts of a mesh right, each group by itself.
class Groups {
 public:
  Groups(const RepairRun& run, const PackedMesh& mesh)
      : mesh_(mesh),
        how_{.insideOut =
                 run.fieldOptions.orientation == Orientation::Keep ? InsideOut::Kept : InsideOut::Turned,
             .closesHoles = run.options.closeHoles,
             .sheetThickness = leastThickness(run.options, run.grid),
             .crack = widestCrack(mesh)} {
    // Plates and isosurfaces may reach beyond open parts.
    const bool areClosed = diagnose(mesh, {.brief = true}).boundaryEdges == 0;
    const double gap = (areClosed ? kClosedGap : kGap) * run.grid.spacing;
    for (std::vector<uint32_t>& faces : groupsApart(mesh, gap)) {
      all_.emplace_back(mesh, std::move(faces));
      area_ += all_.back().area;
    }
  }

  void unite() {
    for (size_t g = 0, given = all_.size(); g < given; ++g) {
      unite(all_[g]);
      if (!all_[g].isRight()) divide(g);
    }
    double sheets = 0.0;
    for (Group& group : all_) {
      group.isKept = group.isRight() && !group.isSheets();
      sheets += group.isSheets() ? group.area : 0.0;
    }
    if (mayBoundSolid(sheets)) return;
    for (Group& group : all_) group.isKept = group.isRight();
  }

  std::vector<Group>& all() { return all_; }
  double area() const { return area_; }

 private:
  void unite(Group& group) const {
    if (all_.size() == 1 || !isAllRight(Model(group.part)))
      return void(group.united = uniteParts(Model(group.part), how_));
    group.united.mesh = group.part;
    group.united.sources.resize(group.faces.size());
    std::iota(group.united.sources.begin(), group.united.sources.end(), 0U);
  }

  /// Returns whether the groups that are sheets, which have some area, may bound a solid together.
  bool mayBoundSolid(double area) const {
    std::vector<uint32_t> faces;
    size_t count = 0;
    for (const Group& group : all_)
      if (group.isSheets()) faces.insert(faces.end(), group.faces.begin(), group.faces.end()), ++count;
    if (count < 2) return false;
    std::ranges::sort(faces);
    Group sheets(mesh_, std::move(faces));
    if (area <= kMostSheets * area_) return findSheets(Model(sheets.part)).boundSolid;
    unite(sheets);
    return !sheets.isRight();
  }

  /// Divides a group that could not be made right into its closed solids and the rest, if these can be.
  void divide(size_t g) {
    const Group& group = all_[g];
    const MeasuredParts parts = measureConnectedParts(group.part);
    if (parts.parts.empty()) return;
    std::vector<bool> isOpen(parts.parts.size());
    for (size_t p = 0; p < isOpen.size(); ++p) isOpen[p] = parts.parts[p].volume <= 0.0;
    std::vector<uint32_t> partOfVertex(group.part.vertices.size());
    for (size_t f = 0; f < parts.ofFace.size(); ++f)
      for (int c = 0; c < 3; ++c) partOfVertex[group.part.triangles[f][c]] = parts.ofFace[f];
    for (const Rim& rim : findRims(group.part, BorderEdges::Unbalanced).closed)
      isOpen[partOfVertex[rim.front().from]] = true;
    std::vector<uint32_t> solids, rest;
    for (size_t f = 0; f < parts.ofFace.size(); ++f)
      (isOpen[parts.ofFace[f]] ? rest : solids).push_back(group.faces[f]);
    if (solids.empty() || rest.empty()) return;
    Group closed(mesh_, std::move(solids)), open(mesh_, std::move(rest));
    unite(closed);
    if (!closed.isRight()) return;
    open.united.failure = group.united.failure;
    all_[g] = std::move(open);
    all_.push_back(std::move(closed));
  }

  const PackedMesh mesh_;
  const UniteOptions how_;
  std::vector<Group> all_;
  double area_ = 0.0;
};

/// Appends a mesh, as seen from the origin of the other.
void append(const Mesh& more, Mesh& mesh) {
  const auto first = uint32_t(mesh.vertices.size());
  const auto position = [&](const glm::vec3& p) {
    return more.origin == mesh.origin ? p : glm::vec3(more.origin + glm::dvec3(p) - mesh.origin);
  };
  for (const glm::vec3& p : more.vertices) mesh.vertices.push_back(position(p));
  for (const glm::uvec3& t : more.triangles) mesh.triangles.push_back(t + first);
}

/// Replaces the faces of a group by those of the whole mesh, or by none where they were added to that.
void toWhole(Group& group, size_t given) {
  group.united.turned = facesOf(group.united.turned, group.faces);
  group.united.inverted.firsts = facesOf(group.united.inverted.firsts, group.faces);
  for (uint32_t& face : group.united.sources) {
    if (face != kNoTriangle) face = group.faces[face];
    if (face >= given) face = kNoTriangle;
  }
}

/// Adds to the report what made a group right.
void report(const UnitedParts& united, double share, RepairRun& run) {
  RepairReport& report = run.report;
  Mended& mended = run.mended;
  std::vector<uint32_t> turned;
  std::ranges::set_symmetric_difference(mended.turned, united.turned, std::back_inserter(turned));
  std::erase_if(turned, [&](uint32_t face) { return face >= run.given.triangles.size(); });
  mended.turned = std::move(turned);
  mended.filled.holes += united.filled.holes;
  mended.filled.faces += united.filled.faces;
  report.unitedFaces += united.cutFaces;
  report.cleanedFaces += united.cleanedFaces;
  report.sewnVertices += united.sewnVertices;
  report.movedVertices += united.movedVertices;
  report.buriedShare += share * united.buriedShare;
  report.lostShare = report.loss.openShare += share * united.lostShare;
  Box& lost = report.loss.openBounds;
  lost.min = glm::min(lost.min, united.lostBounds.min), lost.max = glm::max(lost.max, united.lostBounds.max);
  report.thickenedShare += share * united.thickenedShare;
  if (united.thickenedShare > 0.0) report.leastThickness = leastThickness(run.options, run.grid);
  std::vector<uint32_t>& inverted = report.stats.invertedParts;
  inverted.insert(inverted.end(), united.inverted.firsts.begin(), united.inverted.firsts.end());
}

}  // namespace

bool uniteGroups(RepairRun& run) {
  const RepairOptions& options = run.options;
  const Mesh mesh = weldedCopy(Model(MeshView(run.mesh())));
  Groups groups(run, mesh);
  groups.unite();
  for (const Group& group : groups.all())
    if (!group.isKept && run.report.fieldReason == FieldReason::None)
      run.report.fieldReason = group.isRight() ? FieldReason::Sheet : group.united.failure;
  const bool areAll = run.report.fieldReason == FieldReason::None;
  if (!areAll && (options.triangles > 0 || options.tolerance || leastThickness(options, run.grid) == 0.0))
    return false;
  KeptParts& kept = run.kept;
  Mesh rest{.origin = mesh.origin};
  kept.mesh.origin = mesh.origin;
  for (Group& group : groups.all()) {
    if (!group.isKept || (!areAll && group.united.lostShare > 0.0)) {
      append(group.part, rest);
      kept.rest.insert(kept.rest.end(), group.faces.begin(), group.faces.end());
      continue;
    }
    toWhole(group, run.given.triangles.size());
    report(group.united, group.area / groups.area(), run);
    kept.share += group.area / groups.area();
    append(group.united.mesh, kept.mesh);
    kept.sources.insert(kept.sources.end(), group.united.sources.begin(), group.united.sources.end());
  }
  if (areAll) return true;
  if (kept.sources.empty())
    kept = {};
  else
    run.mended.mesh = std::move(rest);
  run.report.keptFaces = kept.sources.size();
  return false;
}

void joinKept(RepairRun& run) {
  const KeptParts& kept = run.kept;
  if (kept.sources.empty()) return;
  Mesh& result = run.result;
  std::vector<uint32_t>& sources = run.repaired.faceSource = kept.sources;
  append(std::exchange(result, kept.mesh), result);
  sources.resize(result.triangles.size(), kNoTriangle);
  if (!isAllRight(Model(result))) {
    // Parts that were kept touch the rest.
    SettledUnion settled = settleUnion(result, true);
    if (settled.isRight) {
      for (uint32_t& face : settled.sources) face = face == kNoTriangle ? face : sources[face];
      sources = std::move(settled.sources);
      result = std::move(settled.mesh);
    }
  }
  if (run.options.roundResult) run.options.roundResult(result);
}

}  // namespace raymap
