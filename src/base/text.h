#pragma once

#include <string>

namespace raymap {

/// Returns a number for messages with up to `digits` digits, whatever the locale: "0.0001", "1e-09", "12.5".
std::string numberText(double value, int digits = 9);
/// Returns the shortest text that reads back as the same number of single precision.
std::string numberText(float value);
/// Rounds a positive number down to two digits, for advice.
double roundDown(double number);

}  // namespace raymap
