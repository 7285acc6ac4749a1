// Samples as text that is short: whole numbers, their differences, deflated.

#include "render/pack_samples.h"

#include <raymap/error.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace raymap {

namespace {

/// Returns the differences of whole numbers from what the seven neighbours before each suggest (L. Ibarria et
/// al., "Out-of-core compression and decompression of large n-dimensional scalar fields", 2003): nearly zero
/// where the numbers are smooth. Low bytes come before high ones.
std::vector<uint8_t> differences(const Grid& grid, const std::vector<int16_t>& values) {
  const glm::ivec3 dims = grid.dims;
  std::vector<uint8_t> bytes(2 * values.size());
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i) {
        const auto at = [&](int dx, int dy, int dz) {
          return i < dx || j < dy || k < dz ? 0 : int(values[grid.index({i - dx, j - dy, k - dz})]);
        };
        const int suggested =
            at(1, 0, 0) + at(0, 1, 0) + at(0, 0, 1) - at(1, 1, 0) - at(1, 0, 1) - at(0, 1, 1) + at(1, 1, 1);
        const size_t sample = grid.index({i, j, k});
        const auto difference = static_cast<uint16_t>(values[sample] - suggested);
        bytes[sample] = static_cast<uint8_t>(difference & 255u);
        bytes[values.size() + sample] = static_cast<uint8_t>(difference >> 8);
      }
  return bytes;
}

/// The best compression saves 3 % more, but takes 15 times as long: most of the time of a page.
std::vector<uint8_t> deflated(std::span<const uint8_t> bytes) {
  uLongf size = compressBound(uLong(bytes.size()));
  std::vector<uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), uLong(bytes.size()), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw Error(ErrorCode::Memory, "there is not enough memory to compress a field for a page");
  packed.resize(size);
  return packed;
}

}  // namespace

std::string base64(std::span<const uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(bytes.size() - i, 3);
    uint32_t three = 0;
    for (size_t b = 0; b < 3; ++b) three = three << 8 | (b < count ? bytes[i + b] : 0u);
    for (size_t d = 0; d < 4; ++d) text += d <= count ? kDigits[three >> (18 - 6 * d) & 63u] : '=';
  }
  return text;
}

std::string packSamples(const Grid& grid, std::span<const float> numbers, double step) {
  std::vector<int16_t> values(numbers.size());
  std::ranges::transform(numbers, values.begin(),
                         [&](float number) { return static_cast<int16_t>(std::lround(number / step)); });
  return base64(deflated(differences(grid, values)));
}

}  // namespace raymap
