#include "base/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace raymap {

namespace {

/// Returns whether a character commands a terminal, turns the direction of text, or ends a line.
bool isUnprintable(uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

void appendCode(std::string& text, const char* prefix, uint32_t code, size_t digits) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  text += prefix;
  for (size_t i = digits; i > 0; --i) text += kDigits[code >> (4 * (i - 1)) & 0xfU];
}

}  // namespace

size_t decodeUtf8(std::string_view text, uint32_t& code) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned lead = byte(0);
  code = lead;
  if (lead < 0x80) return text.empty() ? 0 : 1;
  const size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  code = lead & (0xffU >> (bytes + 1));
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fU);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool isSurrogate = code >= 0xd800 && code < 0xe000;
  return lead >= 0xc0 && lead < 0xf8 && code >= kLeast[bytes] && code <= 0x10ffff && !isSurrogate ? bytes : 0;
}

std::string printableText(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    uint32_t code = 0;
    const size_t bytes = decodeUtf8(text, code);
    if (bytes == 0)
      appendCode(result, "\\x", static_cast<unsigned char>(text[0]), 2);
    else if (isUnprintable(code))
      appendCode(result, code < 0x100 ? "\\x" : "\\u", code, code < 0x100 ? 2 : 4);
    else
      result += text.substr(0, bytes);
    text.remove_prefix(std::max<size_t>(bytes, 1));
  }
  return result;
}

std::string shortText(std::string_view text, size_t most) {
  size_t end = 0;
  uint32_t code = 0;
  for (size_t i = 0; i < most && end < text.size(); ++i)
    end += std::max<size_t>(decodeUtf8(text.substr(end), code), 1);
  return printableText(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

std::string excerpt(std::string_view text, size_t most) {
  return "'" + shortText(text, most) + "'";
}

std::string withExcerpts(std::string_view message) {
  constexpr size_t kLongest = 300;
  message = message.substr(0, kLongest);
  const auto isQuote = [&](size_t at) {  // And no apostrophe.
    return message[at] == '"' ||
           (message[at] == '\'' &&
            (at == 0 || std::isalpha(static_cast<unsigned char>(message[at - 1])) == 0));
  };
  std::string result;
  for (size_t at = 0; at < message.size();) {
    size_t end = at + 1;
    if (isQuote(at)) {
      end = std::min(message.find(message[at], at + 1), message.size());
      result += excerpt(message.substr(at + 1, end - at - 1));
      at = end + 1;
      continue;
    }
    while (message[at] != ' ' && end < message.size() && message[end] != ' ' && !isQuote(end)) ++end;
    result += shortText(message.substr(at, end - at));
    at = end;
  }
  return result;
}

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
