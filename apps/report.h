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

/// "418 boundary edges, 2 duplicate faces", or "nothing".
std::string describeDefects(const Diagnostics& found);

/// "1,234,567".
std::string grouped(size_t number);
/// "1 edge", "1,234 edges".
std::string counted(size_t number, const std::string& thing);
/// "1.23 GB".
std::string sizeText(size_t bytes);

/// "wrote scan.vdb, 1.23 MB" on stdout.
void printWritten(const std::filesystem::path& path);

/// The most memory this process has held, in bytes.
size_t peakMemory();

}  // namespace raymap
