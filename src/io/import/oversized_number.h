#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raymap {

/// Returns the first count, stride or offset of a DAE's text that is larger than the file, with its line. No
/// whole file has one. Counts of corners in <vcount> are among them.
std::optional<std::string> oversizedNumber(std::string_view text);

}  // namespace raymap
