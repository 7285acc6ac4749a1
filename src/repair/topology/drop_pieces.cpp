#include "repair/topology/drop_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/text.h"
#include "mesh/compact.h"
#include "predicates/line_triangle.h"

namespace raymap {

namespace {

constexpr double kShareOfLargest = 1e-3;  // Smaller parts are crumbs if no volume is given.

constexpr double kSimilar =
    0.1;  // Share of a part that stays from which on a dropped one is worth a warning.

enum class Fate : uint8_t { Kept, Dropped, Filled, Buried };

double leastVolume(const Pieces& found, const RepairOptions& repair) {
  if (repair.dropSmaller) return *repair.dropSmaller;
  double largest = 0.0;
  for (const Piece& piece : found.pieces) largest = std::max(largest, piece.volume);
  return kShareOfLargest * largest;
}

/// Returns what becomes of a piece; `around` is the fate of the piece around it.
Fate fateOf(const Piece& piece, Fate around, bool isSmall, bool keepsCavities) {
  if (around == Fate::Filled || around == Fate::Buried) return Fate::Buried;
  if (around == Fate::Dropped) return Fate::Dropped;
  if (piece.isCavity()) return keepsCavities ? Fate::Kept : Fate::Filled;
  return isSmall ? Fate::Dropped : Fate::Kept;
}

/// Returns the fates of all pieces. Pieces around others are decided first: they are larger.
std::vector<Fate> decide(const Pieces& found, double least, bool keepsCavities,
                         const std::vector<bool>& needed) {
  std::vector<uint32_t> order(found.pieces.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::greater(),
                           [&](uint32_t p) { return std::abs(found.pieces[p].volume); });
  std::vector<Fate> fates(found.pieces.size(), Fate::Kept);
  for (const uint32_t p : order) {
    const Piece& piece = found.pieces[p];
    const Fate around = piece.around == Piece::kNone ? Fate::Kept : fates[piece.around];
    const bool isSmall = piece.volume < least && (needed.empty() || !needed[p]);
    fates[p] = fateOf(piece, around, isSmall, keepsCavities);
  }
  return fates;
}

void count(Removed& removed, double volume) {
  ++removed.count;
  removed.volume += volume;
  removed.largest = std::max(removed.largest, volume);
}

double smallestKept(const Pieces& found, const Choice& choice) {
  double smallest = INFINITY;
  for (size_t p = 0; p < found.pieces.size(); ++p)
    if (!choice.isDropped[p] && !found.pieces[p].isCavity())
      smallest = std::min(smallest, found.pieces[p].volume);
  return smallest;
}

std::string counted(const Removed& removed, const char* one, const char* many) {
  return std::to_string(removed.count) + (removed.count == 1 ? one : many) + ", the largest of volume " +
         numberText(removed.largest, 3);
}

std::string parts(const Removed& removed) {
  return counted(removed, " part", " parts");
}

/// Crossing of a row of samples along x with a surface.
struct Passage {
  size_t row;
  double x;  // In samples.

  bool operator<(const Passage& other) const { return std::pair(row, x) < std::pair(other.row, other.x); }
};

void findPassages(const Grid& grid, const Mesh& surface, const glm::uvec3& triangle,
                  std::vector<Passage>& passages) {
  const auto corner = [&](int c) { return (surface.position(triangle[c]) - grid.origin) / grid.spacing; };
  const glm::dvec3 a = corner(0), b = corner(1), c = corner(2);
  const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(glm::min(glm::min(a, b), c))), 0);
  const glm::ivec3 high = glm::min(glm::ivec3(glm::floor(glm::max(glm::max(a, b), c))), grid.dims - 1);
  for (int k = low.z; k <= high.z; ++k)
    for (int j = low.y; j <= high.y; ++j)
      if (const std::optional<double> x = crossingAt(a, b, c, j, k))
        passages.push_back({grid.index({0, j, k}), *x});
}

/// Sets the samples of a row from one on up to x = `end`, of a narrow band those in leaves.
void fillRow(Field& solid, const glm::ivec3& first, int end, float value) {
  if (!solid.narrow) {
    for (glm::ivec3 s = first; s.x < end; ++s.x) solid.distance[solid.grid.index(s)] = value;
    return;
  }
  for (glm::ivec3 s = first; s.x < end;) {
    const std::optional<size_t> place = solid.narrow->find(s);
    const int next = std::min(end, (s.x / NarrowBand::kLeafSide + 1) * NarrowBand::kLeafSide);
    if (place) std::fill_n(solid.distance.data() + *place, next - s.x, value);
    s.x = next;
  }
}

}  // namespace

Choice choosePieces(const Pieces& found, const RepairOptions& repair, bool keepsCavities,
                    RepairReport& report, const std::vector<bool>& needed) {
  report.dropSmaller = leastVolume(found, repair);
  report.dropped = report.filled = report.buried = {};
  const std::vector<Fate> fates = decide(found, report.dropSmaller, keepsCavities, needed);
  Choice choice{.isDropped = std::vector<bool>(fates.size())};
  for (size_t p = 0; p < fates.size(); ++p) {
    choice.isDropped[p] = fates[p] != Fate::Kept;
    choice.count += choice.isDropped[p] ? 1 : 0;
    const Piece& piece = found.pieces[p];
    if (fates[p] == Fate::Filled)
      count(report.filled, -piece.volume);
    else if (fates[p] != Fate::Kept && !piece.isCavity())
      count(fates[p] == Fate::Dropped ? report.dropped : report.buried, piece.volume);
  }
  return choice;
}

Choice opposite(const Choice& choice) {
  Choice result{choice.isDropped, choice.isDropped.size() - choice.count};
  result.isDropped.flip();
  return result;
}

void dropFrom(Field& solid, const Mesh& surface, const Pieces& found, const Choice& choice) {
  const Grid& grid = solid.grid;
  const auto isOutermost = [&](uint32_t p) {
    const uint32_t around = found.pieces[p].around;
    return choice.isDropped[p] && (around == Piece::kNone || !choice.isDropped[around]);
  };
  const float far = static_cast<float>(grid.spacing * (grid.dims.x + grid.dims.y + grid.dims.z));
  for (const bool isCavity : {false, true}) {
    std::vector<Passage> passages;
    for (size_t f = 0; f < found.ids.size(); ++f)
      if (const uint32_t p = found.ids[f]; isOutermost(p) && found.pieces[p].isCavity() == isCavity)
        findPassages(grid, surface, surface.triangles[f], passages);
    std::sort(passages.begin(), passages.end());
    for (size_t p = 0; p + 1 < passages.size(); p += 2) {
      const auto row = int64_t(passages[p].row), nx = int64_t(grid.dims.x), ny = int64_t(grid.dims.y);
      const glm::ivec3 first(std::max(0.0, std::ceil(passages[p].x)), row / nx % ny, row / (nx * ny));
      const int end = int(std::clamp(std::floor(passages[p + 1].x), -1.0, grid.dims.x - 1.0) + 1.0);
      fillRow(solid, first, end, isCavity ? -far : far);
    }
  }
}

void dropFrom(Mesh& surface, const Pieces& found, const Choice& choice) {
  size_t face = 0;
  std::erase_if(surface.triangles, [&](const glm::uvec3&) { return choice.isDropped[found.ids[face++]]; });
  removeUnusedVertices(surface);
}

void warnOfRemoved(const Pieces& found, const Choice& choice, const RepairReport& report,
                   const WarningCallback& warn) {
  const double smallest = smallestKept(found, choice);
  if (report.dropped.count > 0 && report.dropped.largest >= kSimilar * smallest)
    warn({WarningCode::PartsDropped,
          "dropped " + parts(report.dropped) + ", while a part of volume " + numberText(smallest, 3) +
              " stays; a least volume of 0 keeps all",
          {.count = report.dropped.count, .volume = report.dropped.largest}});
  if (report.filled.count > 0 && report.filled.largest >= report.dropSmaller)
    warn({WarningCode::CavitiesFilled,
          "filled " + counted(report.filled, " sealed cavity", " sealed cavities") + "; cavities can be kept",
          {.count = report.filled.count, .volume = report.filled.largest}});
  if (report.buried.count > 0)
    warn({WarningCode::PartsBuried,
          "filled cavities that held " + parts(report.buried) + "; cavities can be kept",
          {.count = report.buried.count, .volume = report.buried.largest}});
}

void warnOfKept(const RepairReport& report, const WarningCallback& warn) {
  if (report.dropped.count > 0)
    warn({WarningCode::PartsKept,
          "kept " + parts(report.dropped) + ", less than a thousandth of the largest part (" +
              numberText(report.dropSmaller, 3) +
              "), because nothing is wrong with the mesh; a least volume drops them",
          {.count = report.dropped.count, .volume = report.dropped.largest}});
}

void countPieces(const Model& result, RepairReport& report) {
  for (const Piece& piece : findPieces(result).pieces) ++(piece.isCavity() ? report.cavities : report.solids);
}

}  // namespace raymap
