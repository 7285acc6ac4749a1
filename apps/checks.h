#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "options.h"

namespace raymap {

/// Returns the number that a text is; none if it is no number.
std::optional<double> numberIn(const std::string& text);

/// Returns a choice as the program spells it. Throws `Error(Usage)` if it is none.
std::string chosen(const std::vector<std::string>& choices, const std::string& text);

/// Returns a value as its option reads it: a size such as 1.5GB as its number of bytes, in units of powers of
/// 1024; a whole number, which may be octal or hexadecimal, in decimal. Throws `Error(Usage)` if the option
/// does not take it.
std::string checkedValue(const OptionRow& row, const std::string& text);

/// A file to read, and the extensions of the formats that it may have.
struct Input {
  std::filesystem::path& path;
  std::vector<std::string> extensions;
};

/// A file to write, the option that names it and its accepted extensions. An empty path: not wanted.
struct Output {
  std::string option;
  std::filesystem::path& path;
  std::vector<std::string> extensions;
};

/// Option --format as given, and the extensions that it stands for; "": the names or the bytes tell. Further
/// options for files.
struct StreamFormat {
  std::string given;
  std::string input, output;
  std::string grid;           ///< Option --grid: name of the grid to read.
  bool mayOverwrite = false;  ///< Option --overwrite.
};

/// Prepares the files of a command:
/// - Replaces - by standard input or output. If data goes there, all text goes to stderr from now on.
/// - Finds which files --format is about: those to write whose names do not tell their format, or else those
///   to read.
/// - Finds what would fail at the end of a long run: an unknown extension, a missing or read-only folder, a
///   file named twice, an output that is an input.
///
/// Throws `Error(Usage)` or `Error(File)`.
void prepareFiles(StreamFormat& format, const std::vector<Input>& inputs, const std::vector<Output>& outputs);

/// Throws `Error(Usage)` if an output is the same file as an input, also through links.
void checkInputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs);

/// Returns whether a path has one of these extensions, in upper or lower case.
bool hasExtension(const std::filesystem::path& path, const std::vector<std::string>& extensions);

}  // namespace raymap
