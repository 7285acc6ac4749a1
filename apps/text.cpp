#include "text.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

namespace raymap {

std::vector<std::string> split(std::string_view text, char separator) {
  std::istringstream stream(std::string(text) + separator);
  std::vector<std::string> parts;
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::vector<std::string> wordsOf(std::string_view text) {
  std::istringstream stream{std::string(text)};
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string joined(const std::vector<std::string>& parts, const char* separator, const char* last) {
  std::string text;
  for (size_t k = 0; k < parts.size(); ++k)
    text += (k == 0 ? "" : k + 1 < parts.size() ? separator : last) + parts[k];
  return text;
}

std::string joined(const std::vector<std::string>& parts, const char* separator) {
  return joined(parts, separator, separator);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return result;
}

std::string replaced(std::string text, std::string_view part, std::string_view replacement) {
  for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + replacement.size()))
    text.replace(at, part.size(), replacement);
  return text;
}

}  // namespace raymap
