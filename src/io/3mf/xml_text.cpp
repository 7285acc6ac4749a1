#include "io/3mf/xml_text.h"

#include <algorithm>

#include "base/text.h"

namespace raymap {

namespace {

/// Returns the length in bytes of the UTF-8 character that a text begins with; 0 if it is none that XML
/// allows.
size_t characterBytes(std::string_view text) {
  uint32_t code = 0;
  const size_t bytes = decodeUtf8(text, code);
  return code >= 0x20 && code != 0x7f && (code & 0xfffeU) != 0xfffe ? bytes : 0;
}

}  // namespace

std::string xmlText(std::string_view text) {
  std::string xml;
  while (!text.empty()) {
    const size_t bytes = characterBytes(text);
    const char first = text[0];
    if (bytes == 0)
      xml += '?';
    else if (first == '&' || first == '<' || first == '>' || first == '"')
      xml += first == '&' ? "&amp;" : first == '<' ? "&lt;" : first == '>' ? "&gt;" : "&quot;";
    else
      xml += text.substr(0, bytes);
    text.remove_prefix(std::max<size_t>(bytes, 1));
  }
  return xml;
}

}  // namespace raymap
