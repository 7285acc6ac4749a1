#pragma once

#include <raymap/field.h>

#include <vector>

#include "picture/colour.h"

namespace raymap {

/// Colours of numbers that are not distances, as slices of three dimensions and pages show them.
struct Colouring {
  /// A number and its colour. Between two of them, colours are mixed.
  struct Stop {
    double number;
    Colour colour;
  };
  std::vector<Stop> stops = {};  ///< In ascending order, at most `kMostStops`.
  double lineStep = 1.0;         ///< Distance between iso-lines.
  bool isOnSurface = false;      ///< Whether they colour the surface too.

  /// Returns the colour of a number, and for NaN that of numbers which are not known.
  Colour at(double number) const;
};

/// Returns the colours of winding numbers or of confidences.
Colouring colouringOf(FieldArray array);

/// Returns the colours of differences: blue below 0, red above, deepest from `range` on.
Colouring differenceColouring(double range);

}  // namespace raymap
