#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// Accepts a finite number of at least `low`; above `low` if `isOpen`.
CLI::Validator numberFrom(double low, bool isOpen = false);

/// Accepts any finite number.
CLI::Validator anyNumber();

/// Accepts a whole number of at least `low` that fits into an int.
CLI::Validator wholeNumberFrom(int low);

/// Accepts a whole number from 0 on that fits into 64 bits.
CLI::Validator wholeNumber();

/// Replaces a size such as 500MB, 1.5GB or 1e9 by its number of bytes. Units are powers of 1024.
CLI::Validator sizeInBytes();

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

/// Option --format as given, and the extensions that it stands for; "": the names or the bytes tell.
struct StreamFormat {
  std::string given;
  std::string input, output;
  std::string grid;  ///< Option --grid: name of the grid to read.
};

/// Prepares the files of a command:
/// - Replaces - by standard input or output. If data goes there, all text goes to stderr from now on.
/// - Finds which files --format is about: those to write whose names do not tell their format, or else those
///   to read.
/// - Finds what would fail at the end of a long run: an unknown extension, a missing or read-only folder, a
///   file named twice.
///
/// Throws `Error(Usage)` or `Error(File)`.
void prepareFiles(StreamFormat& format, const std::vector<Input>& inputs, const std::vector<Output>& outputs);

/// Throws `Error(Usage)` if an output is the same file as an input, also through links.
void checkInputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs);

/// Returns words as "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

/// Returns whether a path has one of these extensions, in upper or lower case.
bool hasExtension(const std::filesystem::path& path, const std::vector<std::string>& extensions);

}  // namespace raymap
