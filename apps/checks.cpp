#include "checks.h"

#include <raymap/error.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "terminal.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStdin = "/dev/stdin";
constexpr const char* kStdout = "/dev/stdout";

std::string listOf(const std::vector<std::string>& extensions) {
  std::string text;
  for (const std::string& extension : extensions) text += (text.empty() ? "" : " ") + extension;
  return text;
}

/// Returns "one of .ply .stl", or ".png".
std::string endings(const std::vector<std::string>& extensions) {
  return (extensions.size() > 1 ? "one of " : "") + listOf(extensions);
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
  std::string name = (format.given.starts_with('.') ? "" : ".") + format.given;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
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
  std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return std::toupper(c); });
  double factor = 1.0;
  for (const char* prefix : {"", "K", "M", "G", "T"}) {
    const std::string name = prefix;
    if (unit == name || unit == name + "B" || (!name.empty() && unit == name + "IB")) return factor;
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

namespace {

/// Accepts a text that is a value which `isIn` accepts.
template <class Value, class IsIn>
CLI::Validator valueIn(const std::string& range, IsIn isIn) {
  return {[=](const std::string& text) -> std::string {
            Value value{};
            const bool isNegated =
                std::is_unsigned_v<Value> && text.starts_with('-');  // CLI11 would wrap it.
            if (!isNegated && CLI::detail::lexical_cast(text, value) && isIn(value)) return {};
            return "must be " + range + ", not " + text;
          },
          ""};
}

}  // namespace

CLI::Validator numberFrom(double low, bool isOpen) {
  return valueIn<double>(
      std::string("a number ") + (isOpen ? "above " : "at least ") + CLI::detail::to_string(low),
      [=](double value) { return std::isfinite(value) && (isOpen ? value > low : value >= low); });
}

CLI::Validator anyNumber() {
  return valueIn<double>("a number", [](double value) { return std::isfinite(value); });
}

CLI::Validator wholeNumberFrom(int low) {
  return valueIn<int>(
      "a whole number from " + std::to_string(low) + " to " + std::to_string(std::numeric_limits<int>::max()),
      [=](int value) { return value >= low; });
}

CLI::Validator wholeNumber() {
  return valueIn<uint64_t>("a whole number from 0 to " + std::to_string(std::numeric_limits<uint64_t>::max()),
                           [](uint64_t) { return true; });
}

CLI::Validator sizeInBytes() {
  return {[](std::string& text) -> std::string {
            const std::optional<uint64_t> bytes = bytesOf(text);
            if (!bytes) return "must be a size such as 500MB, 1.5GB or 1e9, not " + text;
            text = std::to_string(*bytes);
            return {};
          },
          ""};
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string list;
  for (size_t i = 0; i < words.size(); ++i)
    list += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
  return list;
}

bool hasExtension(const fs::path& path, const std::vector<std::string>& extensions) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

void prepareFiles(StreamFormat& format, const std::vector<Input>& inputs,
                  const std::vector<Output>& outputs) {
  nameStandardInput(inputs);
  nameStandardOutput(outputs);
  assignFormat(format, inputs, outputs);
  checkOutputs(outputs, format.output);
  for (const Output& output : outputs)
    if (output.path == kStdout) output.path = keepStdoutForData();
  silenceText();
}

}  // namespace raymap
