#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// Returns the parts of a text between separators: at least one, and some may be empty.
std::vector<std::string> split(std::string_view text, char separator);

/// Returns the parts of a text between blanks and line ends; none is empty.
std::vector<std::string> wordsOf(std::string_view text);

/// Returns the parts as one text, with `separator` between them, and `last` before the last one: "a, b or c".
std::string joined(const std::vector<std::string>& parts, const char* separator, const char* last);
std::string joined(const std::vector<std::string>& parts, const char* separator);

/// Returns a text without capitals.
std::string lower(std::string_view text);

/// Returns a text with each `part` replaced.
std::string replaced(std::string text, std::string_view part, std::string_view replacement);

}  // namespace raymap
