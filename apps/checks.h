#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// A finite number of at least (or, if `isOpen`, above) `low`.
CLI::Validator numberFrom(double low, bool isOpen = false);

/// A whole number of at least `low` that fits into an int.
CLI::Validator wholeNumberFrom(int low);

/// A file to write, the option that names it and the endings it may have; no path if it is not wanted.
struct Output {
  std::string option;
  std::filesystem::path path;
  std::vector<std::string> extensions;
};

/// Finds what would fail at the end of a long run: an unknown ending, a missing or read-only folder, a file
/// named twice. Throws `Error(Usage)` or `Error(File)`.
void checkOutputs(const std::vector<Output>& outputs);

bool hasExtension(const std::filesystem::path& path, const std::vector<std::string>& extensions);

}  // namespace raymap
