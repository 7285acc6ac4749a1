#pragma once

#include <raymap/diagnostics.h>
#include <raymap/generate.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace raymap {

using Json = nlohmann::ordered_json;

Json toJson(const glm::dvec3& v);
Json toJson(const Diagnostics& found);
Json toJson(const SelfIntersections& found);
Json toJson(const Stats& stats);

/// Returns, for example, "418 boundary edges, 2 duplicate faces"; "nothing" if there is none.
std::string describeDefects(const Diagnostics& found);

/// Returns a number as "1,234,567".
std::string grouped(size_t number);
/// Returns a count as "1 edge" or "1,234 edges".
std::string counted(size_t number, const std::string& thing);
/// Returns a number of bytes as "1.23 GB".
std::string sizeText(size_t bytes);

/// Prints "wrote scan.vdb, 1.23 MB".
void printWritten(const std::filesystem::path& path);

/// Returns the most memory that this process has held, in bytes.
size_t peakMemory();

}  // namespace raymap
