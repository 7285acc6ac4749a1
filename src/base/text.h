#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace raymap {

/// Returns a number for messages with up to `digits` digits, whatever the locale: "0.0001", "1e-09", "12.5".
std::string numberText(double value, int digits = 9);
/// Returns the shortest text that reads back as the same number of single precision.
std::string numberText(float value);
/// Returns the length in bytes of the UTF-8 character that a text begins with, and sets its code; 0 if it is
/// none.
size_t decodeUtf8(std::string_view text, uint32_t& code);
/// Returns a text as UTF-8 in which these are escaped: control characters (\x1b), characters that turn the
/// direction of the text around them or end a line (\u202e), and bytes that are no UTF-8 (\xe9).
std::string printableText(std::string_view text);
/// Returns the first `most` characters of a text, printable, for messages: they must not give away what a
/// file holds that is not what its name says.
std::string shortText(std::string_view text, size_t most = 20);
/// Returns the same in quotes.
std::string excerpt(std::string_view text, size_t most = 20);
/// The most characters of a name that a file gives to one of its parts.
inline constexpr size_t kLongestName = 80;
/// Returns a message of another library as printable text. No text in quotes and no word has more than
/// 20 characters. It ends after the first 300 bytes of the message.
std::string withExcerpts(std::string_view message);
/// Rounds a positive number down to two digits, for advice.
double roundDown(double number);

}  // namespace raymap
