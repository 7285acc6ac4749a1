#pragma once

#include <raymap/render.h>

#include <optional>
#include <string>
#include <vector>

namespace raymap::view {

/// A colour bar, and what its numbers mean.
struct Legend {
  ColourBar bar = {};
  std::vector<double> levels = {};      ///< Numbers of the surface, in ascending order.
  std::vector<std::string> sides = {};  ///< Meaning of the numbers below, between and above the levels.
};

/// Returns what the colours of a view mean. `range` is that of a difference, if one is in colour.
Legend legendOf(const RenderOptions& view, std::optional<double> range);

void showLegend(const Legend& legend);

/// Says at the top right of the window that a picture is not as fine as it will be; `share` of it is.
void showRefining(double share);

}  // namespace raymap::view
