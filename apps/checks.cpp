#include "checks.h"

#include <raymap/error.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "terminal.h"
#include "text.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStdin = "/dev/stdin";
constexpr const char* kStdout = "/dev/stdout";

/// Returns "one of .ply .stl", or ".png".
std::string endings(const std::vector<std::string>& extensions) {
  return (extensions.size() > 1 ? "one of " : "") + joined(extensions, " ");
}

/// Returns whether a path leads to a pipe, a device, or a descriptor such as /dev/stdout.
bool isStream(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return path == kStdout || path.string().starts_with("/dev/fd/") ||
         (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status));
}

/// Returns whether --format must say the format of a file.
bool needsFormat(const fs::path& path, const std::vector<std::string>& extensions) {
  return !path.empty() && extensions.size() > 1 && !hasExtension(path, extensions);
}

void checkOutput(const Output& output, const std::string& format) {
  const std::string start = output.option + " " + output.path.string() + ": ";
  if (needsFormat(output.path, output.extensions) && format.empty())
    throw Error(ErrorCode::Usage, start + "the name must end in " + endings(output.extensions) +
                                      ", or --format must name one of them");
  if (isStream(output.path)) return;
  if (output.extensions.size() == 1 && !hasExtension(output.path, output.extensions))
    throw Error(ErrorCode::Usage, start + "the name must end in " + endings(output.extensions));
  if (fs::is_directory(output.path)) throw Error(ErrorCode::File, start + "is a folder");
  const fs::path folder = output.path.has_parent_path() ? output.path.parent_path() : ".";
  if (!fs::is_directory(folder))
    throw Error(ErrorCode::File, start + "there is no folder " + folder.string() + "; create it first");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(ErrorCode::File, start + "the folder " + folder.string() + " is not writable");
}

void checkOutputs(const std::vector<Output>& outputs, const std::string& format) {
  std::vector<fs::path> seen;
  for (const Output& output : outputs) {
    if (output.path.empty()) continue;
    checkOutput(output, format);
    const fs::path path = isStream(output.path) ? output.path : fs::weakly_canonical(output.path);
    if (std::find(seen.begin(), seen.end(), path) != seen.end())
      throw Error(ErrorCode::Usage, output.option + " " + output.path.string() +
                                        ": another option already writes this file; give each its own");
    seen.push_back(path);
  }
}

void nameStandardInput(const std::vector<Input>& inputs) {
  size_t count = 0;
  for (const Input& input : inputs) {
    if (input.path == "-") input.path = kStdin;
    count += input.path == kStdin ? 1 : 0;
  }
  if (count > 1)
    throw Error(ErrorCode::Usage, "-: standard input can be read once only; give the other file by its name");
}

void nameStandardOutput(const std::vector<Output>& outputs) {
  for (const Output& output : outputs)
    if (output.path == "-" || output.path == "/dev/fd/1" || output.path == "/proc/self/fd/1")
      output.path = kStdout;
}

/// Throws `Error(Usage)` unless a file whose name tells its format has the format `name`.
void checkRepeated(const std::string& name, const std::vector<Input>& inputs,
                   const std::vector<Output>& outputs) {
  std::string files;
  const auto isNamed = [&](const auto& file) {
    if (!file.path.empty()) files += (files.empty() ? "" : " and ") + file.path.string();
    return hasExtension(file.path, {name});
  };
  if (std::ranges::none_of(outputs, isNamed) && std::ranges::none_of(inputs, isNamed))
    throw Error(ErrorCode::Usage, "--format " + name.substr(1) + ": is not what the names of " + files +
                                      " say; leave it out, or rename the file");
}

/// Decides which files --format is about.
void assignFormat(StreamFormat& format, const std::vector<Input>& inputs,
                  const std::vector<Output>& outputs) {
  if (format.given.empty()) return;
  const std::string name = lower((format.given.starts_with('.') ? "" : ".") + format.given);
  std::vector<std::string> asked;
  const auto assign = [&](const auto& files, std::string& to) {
    if (!asked.empty()) return;
    for (const auto& file : files)
      if (needsFormat(file.path, file.extensions))
        asked.insert(asked.end(), file.extensions.begin(), file.extensions.end());
    if (!asked.empty()) to = name;
  };
  assign(outputs, format.output);
  assign(inputs, format.input);
  const std::string start = "--format " + format.given + ": ";
  if (asked.empty()) {
    checkRepeated(name, inputs, outputs);
    return;
  }
  if (std::find(asked.begin(), asked.end(), name) == asked.end())
    throw Error(ErrorCode::Usage, start + "must be " + endings(asked));
}

/// Returns the factor of a unit such as "", "B", "k", "MB" or "GiB"; 0 if there is no such unit.
double factorOf(std::string unit) {
  unit = lower(unit);
  double factor = 1.0;
  for (const char* prefix : {"", "k", "m", "g", "t"}) {
    const std::string name = prefix;
    if (unit == name || unit == name + "b" || (!name.empty() && unit == name + "ib")) return factor;
    factor *= 1024.0;
  }
  return 0.0;
}

/// Returns a size in bytes; none if it is not finite, negative or beyond 2^62.
std::optional<uint64_t> bytesOf(const std::string& text) {
  double number = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(rest, text.data() + text.size());
  if (unit.starts_with(' ')) unit.erase(0, 1);
  const double bytes = number * factorOf(unit);
  const bool isSize = error == std::errc() && factorOf(unit) > 0.0 && bytes >= 0.0 && bytes <= 0x1p62;
  return isSize ? std::optional(static_cast<uint64_t>(bytes)) : std::nullopt;
}

}  // namespace

void checkInputs(const std::vector<Output>& outputs, const std::vector<fs::path>& inputs) {
  for (const Output& output : outputs)
    for (const fs::path& input : inputs)
      if (std::error_code none; !isStream(input) && fs::equivalent(output.path, input, none))
        throw Error(ErrorCode::Usage, output.option + " " + output.path.string() + ": is the input " +
                                          input.string() + "; to replace it: --overwrite");
}

std::optional<double> numberIn(const std::string& text) {
  char* end = nullptr;
  const double value = double(std::strtold(text.c_str(), &end));
  return !text.empty() && end == text.c_str() + text.size() ? std::optional(value) : std::nullopt;
}

namespace {

/// Returns a text that is right. Throws otherwise.
std::string accepted(const std::string& text, bool isRight, const std::string& wanted) {
  if (!isRight) throw Error(ErrorCode::Usage, "must be " + wanted + ", not " + text);
  return text;
}

std::string whole(const std::string& text, uint64_t low, uint64_t high) {
  char* end = nullptr;
  const uint64_t value = std::strtoull(text.c_str(), &end, 0);
  const bool isWhole = !text.empty() && !text.starts_with('-') && end == text.c_str() + text.size();
  accepted(text, isWhole && value >= low && value <= high,
           "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  return std::to_string(value);
}

}  // namespace

std::string chosen(const std::vector<std::string>& choices, const std::string& text) {
  const std::string known = canonical(text);
  accepted(text, std::ranges::count(choices, known) > 0, "one of " + joined(choices, ", "));
  return known;
}

std::string checkedValue(const OptionRow& row, const std::string& text) {
  constexpr uint64_t kMostInt = std::numeric_limits<int>::max();
  if (row.choices != nullptr) return chosen(row.choices(), text);
  if (row.takes <= Takes::Choice) return text;
  const std::optional<double> number = numberIn(text);
  const bool isFinite = number && std::isfinite(*number);
  switch (row.takes) {
    case Takes::Bytes: {
      const std::optional<uint64_t> bytes = bytesOf(text);
      accepted(text, bytes.has_value(), "a size such as 500MB, 1.5GB or 1e9");
      return std::to_string(*bytes);
    }
    case Takes::Count:
      return whole(text, 0, kMostInt);
    case Takes::Natural:
    case Takes::Pair:
    case Takes::Triple:
      return whole(text, 1, kMostInt);
    case Takes::Whole:
      return whole(text, 0, std::numeric_limits<uint64_t>::max());
    case Takes::FromZero:
      return accepted(text, isFinite && *number >= 0.0, "a number at least 0");
    case Takes::AboveZero:
    case Takes::Lengths:
      return accepted(text, isFinite && *number > 0.0, "a number above 0");
    default:
      return accepted(text, isFinite, "a number");
  }
}

bool hasExtension(const fs::path& path, const std::vector<std::string>& extensions) {
  return std::ranges::count(extensions, lower(path.extension().string())) > 0;
}

void prepareFiles(StreamFormat& format, const std::vector<Input>& inputs,
                  const std::vector<Output>& outputs) {
  nameStandardInput(inputs);
  nameStandardOutput(outputs);
  assignFormat(format, inputs, outputs);
  checkOutputs(outputs, format.output);
  for (const Output& output : outputs)
    if (output.path == kStdout) output.path = keepStdoutForData();
  std::vector<fs::path> read;
  for (const Input& input : inputs) read.push_back(input.path);
  if (!format.mayOverwrite) checkInputs(outputs, read);
  silenceText();
}

}  // namespace raymap
