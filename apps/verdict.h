#pragma once

#include <raymap/machine.h>
#include <raymap/mesh.h>
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

/// Returns the command that gives a mesh a thickness.
std::string thickenCommand(double thickness, const std::filesystem::path& mesh);

/// Returns a verdict in plain words: what the mesh is, and what to run. Each line ends with a newline. `path`
/// is the mesh's file.
std::string describe(const Verdict& verdict, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings, const Mesh& mesh,
                     const std::filesystem::path& path, const MachineOptions& machine);

}  // namespace raymap
