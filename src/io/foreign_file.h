#pragma once

#include <string>
#include <string_view>

namespace raymap {

/// Returns what a file is that is beyond doubt no mesh in `format`, and what to do: "it is a PNG picture".
/// Returns an empty text for all others. `head` is its beginning.
std::string foreignKind(std::string_view head, std::string_view format);

}  // namespace raymap
