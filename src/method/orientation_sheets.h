#pragma once

// Ours: which double-sided faces bound a solid, and which are sheets (docs/signs.md).

#include <span>
#include <vector>

#include "method/orientation_surface.h"

namespace raymap {

/// How much double-sided faces, each taken once, look like the boundary of a solid: w is then a whole number
/// on both sides. Around a sheet it is not.
struct Solidity {
  double whole = 0.0, seen = 0.0, rise = 0.0, area = 0.0;

  void add(const Solidity& other) {
    whole += other.whole;
    seen += other.seen;
    rise += other.rise;
    area += other.area;
  }
  /// Returns whether the winding number differs by one between the sides of enough of the surface.
  bool isSeen() const;
  /// Returns 1 for closed surfaces, 0 for a plane sheet.
  double share() const { return whole / seen; }
};

/// The winding number beside the faces.
struct NearSides {
  /// The winding number one cell in front of each face as given, minus that one cell behind it.
  std::span<const float> rises;
  /// How whole it is on both sides. The sum of the winding number one cell in front and one cell behind is
  /// odd where both are whole numbers that differ by 1. The value is 1 less the mean distance of the sum from
  /// the nearest odd number.
  std::span<const float> wholeness;
};

/// Returns twice the area from which on a sheet is seen. `spacing` is the sample spacing.
double leastSheetArea(double spacing);

/// Finds the double-sided faces that are sheets, after all were taken once.
class SheetFinder {
 public:
  /// `spacing` is the sample spacing in the mesh's units. `faces` are those that `surface` takes once,
  /// `parts` the parts of its patches.
  SheetFinder(double spacing, const DoubleSidedFaces& faces, const OrientationSurface& surface,
              const std::vector<uint32_t>& parts);

  /// Takes all faces of the groups as given again that look like sheets. Returns whether there are any
  /// new ones.
  bool giveBack(const NearSides& sides, Turns& turns);

  /// Returns whether any group is no sheet.
  bool hasSolid() const;

 private:
  void measure(const NearSides& sides);
  bool looksLikeSheet(uint32_t face) const;

  const DoubleSidedFaces& faces_;
  const OrientationSurface& surface_;
  const std::vector<uint32_t>& parts_;
  double leastArea_;                        ///< Twice the area from which on a sheet is seen.
  std::vector<uint8_t> isSheet_;            ///< One flag per group.
  std::vector<Solidity> ofPatch_, ofPart_;  ///< Solidity of their double-sided faces.
};

}  // namespace raymap
