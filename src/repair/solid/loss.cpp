#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "cpu/points/local_thickness.h"
#include "repair/stages.h"

namespace raymap {

namespace {

constexpr double kNotableShare = 1e-3;  // Losses of a smaller share of the mesh's area need no warning.
// Share of the lost points that a distance between samples must keep.
constexpr double kKeptShare = 0.995;
// Largest distance from a kept point to a sample inside, in samples.
constexpr double kReach = 1.5;
// Distances to try: each is this much smaller than the last, down to a share of the grid's.
constexpr double kFiner = 1.25, kFinest = 1.0 / 16;

/// Lost sides of the solid.
struct LostSides {
  std::vector<glm::dvec3> points;  // Moved by the offset.
  std::vector<double> diameters;   // Thickness with the offset at both sides; infinite if not known.

  std::vector<double> areas;  // Areas that the points stand for.

  void add(const FacePoint& point, const Thickness& thickness, double offset) {
    areas.push_back(point.area);
    points.push_back(point.position - offset * glm::dvec3(thickness.inward));
    diameters.push_back(double(thickness.diameter) + 2.0 * offset);
  }
};

/// Returns the thickness that half of the area does not exceed, of pairs of thickness and area. Leaves out
/// infinite thickness. 0 if there is none.
double medianOf(std::vector<std::pair<double, double>> sides) {
  std::erase_if(sides, [](const auto& side) { return !std::isfinite(side.first); });
  std::ranges::sort(sides);
  double area = 0.0, below = 0.0;
  for (const auto& side : sides) area += side.second;
  for (const auto& side : sides)
    if ((below += side.second) >= 0.5 * area) return std::max(side.first, 0.0);
  return 0.0;
}

/// Share of the lost sides that samples at one distance keep.
struct Trial {
  double voxelSize = 0.0;
  double keptShare = 0.0;
  double keptThickness = 0.0;  // Half of what is not kept is thinner.
  double recession = 0.0;      // Largest distance between the bounds of all points and of the kept ones.
};

Box boundsOf(std::span<const glm::dvec3> points) {
  Box box;
  for (const glm::dvec3& p : points) box.min = glm::min(box.min, p), box.max = glm::max(box.max, p);
  return box;
}

/// Tells for grids what their samples see of the lost sides.
class Trials {
 public:
  Trials(const cpu::PreparedSurface& surface, const LostSides& lost, const RepairOptions& repair,
         Progress& progress)
      : surface_(surface), lost_(lost), repair_(repair), progress_(progress) {}

  /// A point is kept if a sample at most 1.5 samples away is inside. The isosurface reaches
  /// about half a sample beyond it.
  Trial run(double voxelSize) {
    const RepairGrid grid = fitRepairGrid(surface_.mesh, {.voxelSize = voxelSize}, repair_);
    if (grid.surfaceCubes > kMostAdvisedCubes) return {};
    placeSamples(grid);
    cpu::queryPoints(surface_, samples_, {}, progress_, result_);
    Trial trial{voxelSize};
    std::vector<glm::dvec3> kept;
    std::vector<std::pair<double, double>> gone;
    double area = 0.0, keptArea = 0.0;
    for (size_t i = 0; i < lost_.points.size(); ++i) {
      area += lost_.areas[i];
      if (isSeen(i)) {
        kept.push_back(lost_.points[i]);
        keptArea += lost_.areas[i];
      } else {
        gone.emplace_back(lost_.diameters[i], lost_.areas[i]);
      }
    }
    trial.keptShare = area > 0.0 ? keptArea / area : 0.0;
    trial.keptThickness = medianOf(std::move(gone));
    trial.recession = recession(boundsOf(kept));
    return trial;
  }

 private:
  void placeSamples(const Grid& grid) {
    samples_.clear();
    ends_.clear();
    for (const glm::dvec3& p : lost_.points) {
      const glm::dvec3 at = (p - grid.origin) / grid.spacing, low = glm::floor(at) - 1.0;
      for (int s = 0; s < 64; ++s)
        if (const glm::dvec3 sample = low + glm::dvec3(s % 4, s / 4 % 4, s / 16);
            glm::distance(at, sample) <= kReach)
          samples_.push_back(grid.position(sample));
      ends_.push_back(samples_.size());
    }
  }

  bool isSeen(size_t point) const {
    const auto* all = result_.distance.begin();
    return std::any_of(all + (point > 0 ? ends_[point - 1] : 0), all + ends_[point],
                       [&](double d) { return d < repair_.offset; });
  }

  double recession(const Box& kept) const {
    const Box all = boundsOf(lost_.points);
    const glm::dvec3 far = glm::max(kept.min - all.min, all.max - kept.max);
    return std::max({far.x, far.y, far.z});
  }

  const cpu::PreparedSurface& surface_;
  const LostSides& lost_;
  const RepairOptions& repair_;
  Progress& progress_;
  std::vector<glm::dvec3> samples_;  // Those to look at for one point after the other.
  std::vector<size_t> ends_;         // For each point, the end of its samples.
  QueryResult result_;
};

bool isKept(const Trial& trial) {
  return trial.keptShare >= kKeptShare && trial.recession <= trial.voxelSize;
}

/// Finds the largest distance between samples that keeps all. If there is none, returns the one that keeps
/// most: a part that runs out to an edge is kept best where the samples happen to lie in it.
Trial findVoxelSize(Trials& trials, double spacing) {
  Trial best;
  double voxelSize = spacing / kFiner;
  while (voxelSize >= kFinest * spacing) {
    const Trial trial = trials.run(roundDown(voxelSize));
    voxelSize /= kFiner;
    if (trial.voxelSize == 0.0) break;
    if (isKept(trial)) return trial;
    if (trial.keptShare > best.keptShare) best = trial;
  }
  return best;
}

std::string boxText(const Box& box) {
  const auto side = [&](const char* name, double from, double to) {
    return name + (" from " + numberText(from, 6)) + " to " + numberText(to, 6);
  };
  return side("x", box.min.x, box.max.x) + ", " + side("y", box.min.y, box.max.y) + ", " +
         side("z", box.min.z, box.max.z);
}

void addSides(const LostSides& lost, Loss& loss) {
  loss.bounds = boundsOf(lost.points);
  std::vector<std::pair<double, double>> sides;
  for (size_t i = 0; i < lost.points.size(); ++i) sides.emplace_back(lost.diameters[i], lost.areas[i]);
  loss.thinnest = std::max(std::ranges::min(lost.diameters), 0.0);
  loss.medianThickness = medianOf(std::move(sides));
  if (!std::isfinite(loss.thinnest)) loss.thinnest = 0.0;
}

/// Returns whether the wall at a point may be thinner than the grid resolves. Where all walls are thicker,
/// the rims of holes are lost, and no part of the solid.
bool isThin(const Thickness& thickness, double spacing) {
  constexpr double kThick = 4.0;  // In samples.
  return thickness.part == Part::Edge ||
         (thickness.part == Part::Wall && thickness.diameter < kThick * spacing);
}

/// Finds out what the lost points are, and which distance between samples keeps them.
void findLoss(RepairRun& run, Loss& loss) {
  const std::vector<FacePoint>& lost = run.lost;
  if (lost.empty()) return;
  const double spacing = run.grid.spacing;
  const cpu::PreparedSurface& surface = run.surface();
  std::vector<Thickness> thickness(lost.size());
  cpu::measureThickness(surface, lost, INFINITY, run.progress, thickness);
  const bool isAnyThin =
      std::ranges::any_of(thickness, [&](const Thickness& t) { return isThin(t, spacing); });
  LostSides sides;
  std::vector<glm::dvec3> open;
  double solidArea = 0.0, openArea = 0.0;
  for (size_t i = 0; i < lost.size(); ++i) {
    if (isAnyThin && thickness[i].part != Part::Sheet && thickness[i].part != Part::Buried) {
      sides.add(lost[i], thickness[i], run.options.offset);
      solidArea += lost[i].area;
    } else {
      open.push_back(lost[i].position);
      openArea += lost[i].area;
    }
  }
  if (const double area = solidArea + openArea;
      area > 0.0) {  // Either is 0, and not nearly 0, if it has no area.
    loss.solidShare = run.lostShare * (solidArea / area);
    loss.openShare = run.lostShare * (openArea / area);
  }
  if (!open.empty()) loss.openBounds = boundsOf(open);
  if (sides.points.empty()) return;
  addSides(sides, loss);
  Trials trials(surface, sides, run.options, run.progress);
  const Trial best = findVoxelSize(trials, spacing);
  loss.voxelSize = best.voxelSize;
  loss.keptShare = best.keptShare;
  loss.keptThickness = best.keptThickness;
  loss.kept = isKept(best);
}

std::string percentText(double share) {
  return numberText(100.0 * share, 3) + " %";
}

/// Returns how thin the lost parts of the solid are, and what keeps them.
std::string describeSolid(const Loss& loss) {
  std::string message = percentText(loss.solidShare) + " bounds parts of the solid";
  if (loss.medianThickness > 0.0)
    message += ", " + numberText(loss.thinnest, 3) + " thick at the thinnest, " +
               numberText(loss.medianThickness, 3) + " in the median";
  const std::string size = numberText(loss.voxelSize, 3);
  if (loss.kept) return message + ": a voxel size of " + size + " keeps them";
  if (loss.keptShare > 0.0)
    return message + ": no voxel size that fits into memory keeps all, " + size + " keeps " +
           percentText(loss.keptShare) + " of them, and half of the rest is thinner than " +
           numberText(loss.keptThickness, 3);
  return message + ": no voxel size that fits into memory keeps them";
}

Box boundsOf(const Loss& loss) {
  Box box;
  for (const Box& part : {loss.bounds, loss.openBounds, loss.droppedBounds})
    box.min = glm::min(box.min, part.min), box.max = glm::max(box.max, part.max);
  return box;
}

}  // namespace

void warnOfLoss(const Loss& loss, const RepairOptions& repair, const WarningCallback& warn) {
  const double share = loss.solidShare + loss.openShare + loss.droppedShare;
  if (share < kNotableShare) return;
  std::string message = percentText(share) + " of the mesh's surface is lost: " + boxText(boundsOf(loss));
  if (loss.solidShare > 0.0) message += "; " + describeSolid(loss);
  if (loss.openShare > 0.0)
    message += "; " + percentText(loss.openShare) + " is sheets and open surface, which bound no solid";
  if (loss.droppedShare > 0.0)
    message += "; " + percentText(loss.droppedShare) +
               " is parts below the volume to drop: a smaller volume keeps them";
  if (repair.minThickness == 0.0 && (loss.openShare > 0.0 || !loss.kept))
    message += "; without a least thickness of 0, plates keep what is thin";
  const bool isSolid = loss.solidShare > std::max(loss.openShare, loss.droppedShare);
  warn({isSolid ? WarningCode::SolidLost : WarningCode::SurfaceLost,
        message,
        {.share = share, .voxelSize = isSolid ? loss.voxelSize : 0.0}});
}

void inspectLoss(RepairRun& run) {
  Loss& loss = run.report.loss;
  loss.droppedShare = run.report.lostShare - run.lostShare;
  findLoss(run, loss);
  warnOfLoss(loss, run.options, run.machine.warn);
}

}  // namespace raymap
