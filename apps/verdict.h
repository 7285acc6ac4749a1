#pragma once

#include <raymap/units.h>
#include <raymap/verdict.h>

#include <filesystem>
#include <optional>
#include <string>

#include "report.h"

namespace raymap {

/// Returns what a mesh is, and what else is wrong with it, in one line without an end.
std::string describeKind(const Verdict& verdict, const Diagnostics& found,
                         const std::optional<SelfIntersections>& crossings);

/// Returns all of it for programs.
Json toJson(const Verdict& verdict, const Diagnostics& found,
            const std::optional<SelfIntersections>& crossings, const std::optional<LengthUnit>& unit);

/// Returns a verdict in plain words: what the mesh is, and what to run. Each line ends with a newline.
std::string describe(const Verdict& verdict, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings, const std::filesystem::path& mesh);

}  // namespace raymap
