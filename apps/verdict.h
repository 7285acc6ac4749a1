#pragma once

#include <raymap/verdict.h>

#include <filesystem>
#include <optional>
#include <string>

namespace raymap {

/// Returns a verdict in plain words: what the mesh is, and what to run. Each line ends with a newline.
std::string describe(const Verdict& verdict, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings, const std::filesystem::path& mesh);

}  // namespace raymap
