#pragma once

#include <raymap/diagnostics.h>
#include <raymap/export.h>
#include <raymap/verdict.h>

#include <cstddef>
#include <optional>
#include <string>

namespace raymap {

/// Returns a number as "1,234,567".
RAYMAP_API std::string grouped(size_t number);
/// Returns a count as "1 edge" or "1,234 edges".
RAYMAP_API std::string counted(size_t number, const std::string& thing);
/// Returns a number in three digits, or a whole one from a thousand on: "0.125", "1,235".
RAYMAP_API std::string rounded(double number);

/// Returns, for example, "418 boundary edges, 2 crossing pairs of faces"; "nothing" if there is none, and
/// that crossings were not counted if so.
RAYMAP_API std::string describeDefects(const Diagnostics& found,
                                       const std::optional<SelfIntersections>& crossings);

/// Returns what is wrong with how the parts of a mesh lie; nothing if that is right or not known.
RAYMAP_API const char* describe(Arrangement arrangement);

/// Returns why a repair needed a field; nothing if it did not.
RAYMAP_API const char* describe(FieldReason reason);

/// Returns what a mesh is, as the end of "This is …", and in a second sentence what else is wrong with it.
/// Takes what `judge` took and returned.
RAYMAP_API std::string describe(const Verdict& verdict, const Diagnostics& found,
                                const std::optional<SelfIntersections>& crossings);

}  // namespace raymap
