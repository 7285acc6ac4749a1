#pragma once

#include <raymap/units.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace raymap {

/// The units as 3MF names them.
inline constexpr std::array<std::pair<std::string_view, LengthUnit>, 6> kUnits3mf{
    {{"micron", LengthUnit::Micron},
     {"millimeter", LengthUnit::Millimetre},
     {"centimeter", LengthUnit::Centimetre},
     {"inch", LengthUnit::Inch},
     {"foot", LengthUnit::Foot},
     {"meter", LengthUnit::Metre}}};

inline std::optional<LengthUnit> unitOf3mf(std::string_view name) {
  for (const auto& [each, unit] : kUnits3mf)
    if (each == name) return unit;
  return std::nullopt;
}

inline std::string_view nameIn3mf(LengthUnit unit) {
  return std::ranges::find(kUnits3mf, unit, &std::pair<std::string_view, LengthUnit>::second)->first;
}

}  // namespace raymap
