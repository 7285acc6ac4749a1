#include "method/orientation_sheets.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

/// Solidity from which on double-sided faces bound a solid, and the same for a patch of a part that does.
constexpr double kSolid = 0.86, kHalfSolid = 0.5;
/// Share of the surface whose two sides must differ by 1 for the solidity to be measured, give or take
/// `kUnclear`.
constexpr double kLeastSeen = 0.2, kUnclear = 0.3;
/// Least mean rise across a sheet, and the area, in squares of the sample spacing, from which on it is there.
constexpr double kSheetRise = 0.5;
constexpr double kLeastCells = 64.0;

Solidity solidityOf(double area, double rise, double wholeness) {
  const double seen = std::abs(std::abs(rise) - 1.0) < kUnclear ? area : 0.0;
  return {.whole = seen * wholeness, .seen = seen, .rise = area * std::abs(rise), .area = area};
}

}  // namespace

bool Solidity::isSeen() const {
  return seen > kLeastSeen * area;
}

double leastSheetArea(double spacing) {
  return 2.0 * kLeastCells * spacing * spacing;
}

SheetFinder::SheetFinder(double spacing, const DoubleSidedFaces& faces, const OrientationSurface& surface,
                         const std::vector<uint32_t>& parts)
    : faces_(faces),
      surface_(surface),
      parts_(parts),
      leastArea_(leastSheetArea(spacing)),
      isSheet_(faces.firsts.size(), 0) {}

bool SheetFinder::giveBack(const NearSides& sides, Turns& turns) {
  measure(sides);
  bool hasSheets = false;
  for (size_t g = 0; g < faces_.firsts.size(); ++g) {
    if (isSheet_[g] || !looksLikeSheet(faces_.firsts[g])) continue;
    isSheet_[g] = 1;
    hasSheets = true;
    turns[faces_.firsts[g]] = kAsGiven;
  }
  for (size_t o = 0; o < faces_.others.size(); ++o)
    if (isSheet_[faces_.groupOf[o]]) turns[faces_.others[o]] = kAsGiven;
  return hasSheets;
}

bool SheetFinder::hasSolid() const {
  return std::find(isSheet_.begin(), isSheet_.end(), 0) != isSheet_.end();
}

void SheetFinder::measure(const NearSides& sides) {
  ofPatch_.assign(surface_.patches.count, {});
  ofPart_.assign(surface_.patches.count, {});
  for (size_t g = 0; g < faces_.firsts.size(); ++g) {
    if (isSheet_[g]) continue;
    const uint32_t face = faces_.firsts[g], patch = surface_.patches.ids[face];
    const Solidity solidity = solidityOf(surface_.areas[face], sides.rises[face], sides.wholeness[face]);
    ofPatch_[patch].add(solidity);
    ofPart_[parts_[patch]].add(solidity);
  }
}

bool SheetFinder::looksLikeSheet(uint32_t face) const {
  const uint32_t patch = surface_.patches.ids[face];
  if (surface_.borders[patch].areNone()) return false;
  const Solidity &ofPatch = ofPatch_[patch], &ofPart = ofPart_[parts_[patch]];
  // The sides of walls thinner than the samples do not differ. Those of a sheet do, unless it is small.
  if (!ofPart.isSeen())
    return surface_.borders[patch].open > 0 &&
           (ofPart.area < leastArea_ || ofPart.rise > kSheetRise * ofPart.area);
  if (ofPatch.isSeen() && ofPatch.share() >= kSolid) return false;
  return ofPart.share() < kSolid || (ofPatch.isSeen() && ofPatch.share() < kHalfSolid);
}

}  // namespace raymap
