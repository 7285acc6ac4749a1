#include "base/text.h"

#include <array>
#include <charconv>

namespace raymap {

std::string numberText(double value) {
  constexpr int kDigits = 9;
  std::array<char, 32> text{};
  return {
      text.data(),
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits).ptr};
}

std::string numberText(float value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace raymap
