#pragma once

#include <cstdint>

namespace raymap {

/// Unit of a mesh's lengths, as a 3MF states it.
enum class LengthUnit : uint8_t { Micron, Millimetre, Centimetre, Inch, Foot, Metre };

/// Returns how many millimetres a unit has.
constexpr double millimetres(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::Micron:
      return 0.001;
    case LengthUnit::Millimetre:
      return 1.0;
    case LengthUnit::Centimetre:
      return 10.0;
    case LengthUnit::Inch:
      return 25.4;
    case LengthUnit::Foot:
      return 304.8;
    case LengthUnit::Metre:
      return 1000.0;
  }
  return 1.0;
}

}  // namespace raymap
