#include "io/import/oversized_number.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

#include "base/text.h"

namespace raymap {

namespace {

/// Returns whether a number begins the text that is larger than `most`; one beyond 64 bits is, too.
bool isLarger(std::string_view text, uint64_t most) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc::result_out_of_range || (error == std::errc() && value > most);
}

std::string describeNumber(std::string_view text, size_t at, std::string_view name) {
  const size_t length = std::min(text.find_first_not_of("0123456789", at), text.size()) - at;
  return "line " + std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n')) +
         ": " + std::string(name) + " is " + shortText(text.substr(at, length)) +
         ", but the whole file has " + std::to_string(text.size()) + " bytes";
}

}  // namespace

std::optional<std::string> oversizedNumber(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  for (const std::string_view name : {"count", "stride", "offset"})
    for (size_t at = text.find(name); at != text.npos; at = text.find(name, at)) {
      at += name.size();
      if (text.substr(at, 1) == "=" && isLarger(text.substr(std::min(at + 2, text.size())), text.size()))
        return describeNumber(text, at + 2, "'" + std::string(name) + "'");
    }
  constexpr std::string_view kCorners = "<vcount>";
  for (size_t at = text.find(kCorners); at != text.npos; at = text.find(kCorners, at)) {
    at += kCorners.size();
    const size_t end = std::min(text.find('<', at), text.size());
    for (at = text.find_first_not_of(kBlank, at); at < end; at = text.find_first_not_of(kBlank, at)) {
      if (isLarger(text.substr(at, end - at), text.size()))
        return describeNumber(text, at, "a number of <vcount>");
      at = std::min(text.find_first_of(kBlank, at), end);
    }
  }
  return std::nullopt;
}

}  // namespace raymap
