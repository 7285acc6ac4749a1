#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// Accepts a finite number of at least `low`; above `low` if `isOpen`.
CLI::Validator numberFrom(double low, bool isOpen = false);

/// Accepts a whole number of at least `low` that fits into an int.
CLI::Validator wholeNumberFrom(int low);

/// A file to write, the option that names it and its accepted extensions. An empty path: not wanted.
struct Output {
  std::string option;
  std::filesystem::path path;
  std::vector<std::string> extensions;
};

/// Finds what would fail at the end of a long run: an unknown extension, a missing or read-only folder, a
/// file named twice. Throws `Error(Usage)` or `Error(File)`.
void checkOutputs(const std::vector<Output>& outputs);

/// Adds `--overwrite`, which allows outputs that are inputs.
CLI::Option* addOverwriteOption(CLI::App& command, bool& mayOverwrite);

/// Throws `Error(Usage)` if an output is the same file as an input, also through links.
void checkInputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs);

/// Returns whether a path has one of these extensions, in upper or lower case.
bool hasExtension(const std::filesystem::path& path, const std::vector<std::string>& extensions);

}  // namespace raymap
