#pragma once

#include <raymap/grid.h>

#include <cstdint>
#include <span>
#include <string>

namespace raymap {

/// Returns bytes as base64.
std::string base64(std::span<const uint8_t> bytes);

/// Returns the numbers of a grid's samples as a page holds them, in base64. They are rounded to multiples of
/// `step`, of which each may be at most 32767. Throws `Error(Memory)`.
std::string packSamples(const Grid& grid, std::span<const float> numbers, double step);

}  // namespace raymap
