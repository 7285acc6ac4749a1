#pragma once

// Results as JSON, for programs that use nlohmann-json: the command line writes them, and raymap/c.h. It is
// not in raymap/raymap.h, which needs no such library. docs/report.md lists all keys.

#include <raymap/records.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace raymap {

/// Returns JSON as text with a line end: indented by so many blanks, or all on one line with -1. In strings,
/// bytes that are no UTF-8 become U+FFFD.
inline std::string textOf(const nlohmann::ordered_json& json, int indent = 2) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Returns a result of the library (raymap/records.h), or a member of one. Face indices become their number.
/// Other lists keep their first thousand values.
template <class Value>
nlohmann::ordered_json toJson(const Value& value) {
  constexpr size_t kMost = 1000;
  if constexpr (Record<Value>) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    forEachMember(value, [&](const char* name, const auto& member) { json[name] = toJson(member); });
    return json;
  } else if constexpr (std::is_enum_v<Value>) {
    return name(value);
  } else if constexpr (std::is_same_v<Value, glm::dvec3> || std::is_same_v<Value, glm::ivec3>) {
    return {value.x, value.y, value.z};
  } else if constexpr (std::is_same_v<Value, Box>) {
    return toJson(corners(value));
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  } else if constexpr (std::is_same_v<Value, std::vector<uint32_t>>) {
    return value.size();
  } else if constexpr (std::is_same_v<Value, std::string> || !std::is_class_v<Value>) {
    return value;
  } else {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (size_t k = 0; k < std::min(value.size(), kMost); ++k) list.push_back(toJson(value[k]));
    return list;
  }
}

}  // namespace raymap
