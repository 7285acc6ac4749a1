#include "base/text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace raymap {

std::string numberText(double value, int digits) {
  std::array<char, 32> text{};
  return {
      text.data(),
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr};
}

std::string numberText(float value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

double roundDown(double number) {
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  const std::string digits = numberText(std::floor(number / unit * (1.0 + 1e-6)) * unit, 2);
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

}  // namespace raymap
