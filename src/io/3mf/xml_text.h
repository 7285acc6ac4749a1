#pragma once

#include <string>
#include <string_view>

namespace raymap {

/// Returns a text as the content of an XML element or as a value in quotes. Bytes that are no text of XML
/// become '?'.
std::string xmlText(std::string_view text);

}  // namespace raymap
