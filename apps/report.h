#pragma once

#include <raymap/records.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace raymap {

using Json = nlohmann::ordered_json;

/// Returns JSON as text, indented and with a line end. In strings, bytes that are no UTF-8 become U+FFFD.
std::string textOf(const Json& json);

/// Returns a result of the library (raymap/records.h), or a member of one. Face indices become their number.
/// Of other lists, the first thousand values are kept.
template <class Value>
Json toJson(const Value& value) {
  constexpr size_t kMost = 1000;
  if constexpr (Record<Value>) {
    Json json = Json::object();
    forEachMember(value, [&](const char* name, const auto& member) { json[name] = toJson(member); });
    return json;
  } else if constexpr (std::is_enum_v<Value>) {
    return name(value);
  } else if constexpr (std::is_same_v<Value, glm::dvec3> || std::is_same_v<Value, glm::ivec3>) {
    return {value.x, value.y, value.z};
  } else if constexpr (std::is_same_v<Value, Box>) {
    return toJson(corners(value));
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return value ? Json(*value) : Json();
  } else if constexpr (std::is_same_v<Value, std::vector<uint32_t>>) {
    return value.size();
  } else if constexpr (std::is_same_v<Value, std::string> || !std::is_class_v<Value>) {
    return value;
  } else {
    Json list = Json::array();
    for (size_t k = 0; k < std::min(value.size(), kMost); ++k) list.push_back(toJson(value[k]));
    return list;
  }
}

/// Returns, for example, "418 boundary edges, 2 crossing pairs of faces"; "nothing" if there is none, and
/// that crossings were not counted if so.
std::string describeDefects(const Diagnostics& found, const std::optional<SelfIntersections>& crossings);

/// Returns a number as "1,234,567".
std::string grouped(size_t number);
/// Returns a count as "1 edge" or "1,234 edges".
std::string counted(size_t number, const std::string& thing);
/// Returns a number of bytes as "1.23 GB".
std::string sizeText(size_t bytes);

using Clock = std::chrono::steady_clock;

inline double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Does the work of a step of a command, and appends its name and time to `steps`.
template <class Work>
void timeStep(std::vector<Stats::Stage>& steps, const char* name, Work&& work) {
  const Clock::time_point start = Clock::now();
  work();
  steps.push_back({name, millisecondsSince(start)});
}

/// Returns a line for each step, one for the rest of the time that has elapsed, and one for all of it. The
/// rest lies between the steps: checks of the mesh, and freeing memory.
std::string describeTimes(const std::vector<Stats::Stage>& steps, double elapsedMilliseconds);

/// Prints which faces were reversed and left out, if any.
void printOrientation(const Stats& stats);

/// Prints "wrote scan.vdb, 1.23 MB".
void printWritten(const std::filesystem::path& path);

/// Returns the most memory that this process has held, in bytes.
size_t peakMemory();

}  // namespace raymap
