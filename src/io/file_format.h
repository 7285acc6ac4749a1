#pragma once

// Formats of files, as extensions in lower case with the dot.

#include <raymap/io.h>

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "base/source_file.h"

namespace raymap {

using Formats = std::vector<std::string>;

bool contains(const Formats& formats, std::string_view format);

/// Returns the format of a file: the name's extension, or else `given`, or else what the bytes say beyond
/// doubt. Each is used only if it is one of `known`; returns nothing if none does. Throws `Error(File)` if
/// there is no file whose bytes could tell.
std::string formatOf(const SourceFile& source, std::string_view given, const Formats& known);

/// Returns the format that a file's bytes tell beyond doubt; empty if they tell none.
std::string formatOfContent(const SourceFile& source);

/// Returns the format of a file to write: the name's extension, or `given` if that is none of `known`.
std::string formatOf(const std::filesystem::path& path, std::string_view given, const Formats& known);

/// Returns ".ply .obj .stl".
std::string listOf(const Formats& formats);

/// Throws `Error`: Usage if the file's format has no place for what the options ask for, Unsupported if this
/// build cannot write it.
void checkFieldFile(const std::filesystem::path& path, const FieldWriteOptions& options);
/// Returns whether the file's format can store numbers in 16 bits.
bool canHalve(const std::filesystem::path& path, std::string_view given);

/// Writes a file by a function that must be able to go back in its stream. A pipe cannot, so it gets all
/// bytes at the end.
void writeSeekable(std::ostream& out, const std::function<void(std::ostream&)>& write);

// Formats that builds with all libraries read. Those whose library this build lacks are known, to be refused.
Formats knownMeshFormats();
Formats knownFieldFormats();

// Read a file in a known format, which `formatOf` gave.
Mesh readMeshAs(const SourceFile& source, std::string_view format, const ReadOptions& options);
Field readFieldAs(const SourceFile& source, std::string_view format, const ReadOptions& options);

}  // namespace raymap
