#include "checks.h"

#include <raymap/error.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace raymap {

namespace fs = std::filesystem;

namespace {

std::string endings(const std::vector<std::string>& extensions) {
  std::string text = extensions.size() > 1 ? "one of" : "";
  for (const std::string& extension : extensions) text += (text.empty() ? "" : " ") + extension;
  return text;
}

void checkOutput(const Output& output) {
  const std::string start = output.option + " " + output.path.string() + ": ";
  if (!hasExtension(output.path, output.extensions))
    throw Error(ErrorCode::Usage, start + "the name must end in " + endings(output.extensions));
  if (fs::is_directory(output.path)) throw Error(ErrorCode::File, start + "is a folder");
  const fs::path folder = output.path.has_parent_path() ? output.path.parent_path() : ".";
  if (!fs::is_directory(folder))
    throw Error(ErrorCode::File, start + "there is no folder " + folder.string() + "; create it first");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(ErrorCode::File, start + "the folder " + folder.string() + " is not writable");
}

}  // namespace

CLI::Option* addOverwriteOption(CLI::App& command, bool& mayOverwrite) {
  return command.add_flag("--overwrite", mayOverwrite, "Allow an output to replace an input");
}

void checkInputs(const std::vector<Output>& outputs, const std::vector<fs::path>& inputs) {
  for (const Output& output : outputs)
    for (const fs::path& input : inputs)
      if (std::error_code none; fs::equivalent(output.path, input, none))
        throw Error(ErrorCode::Usage, output.option + " " + output.path.string() + ": is the input " +
                                          input.string() + "; to replace it: --overwrite");
}

CLI::Validator numberFrom(double low, bool isOpen) {
  const std::string limit = (isOpen ? "above " : "at least ") + CLI::detail::to_string(low);
  return {[=](const std::string& text) -> std::string {
            double value = 0.0;
            const bool isNumber = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
            if (isNumber && (isOpen ? value > low : value >= low)) return {};
            return "must be a number " + limit + ", not " + text;
          },
          (isOpen ? "> " : ">= ") + CLI::detail::to_string(low)};
}

CLI::Validator wholeNumberFrom(int low) {
  return {[=](const std::string& text) -> std::string {
            int value = 0;
            if (CLI::detail::lexical_cast(text, value) && value >= low) return {};
            return "must be a whole number from " + std::to_string(low) + " to " +
                   std::to_string(std::numeric_limits<int>::max()) + ", not " + text;
          },
          ">= " + std::to_string(low)};
}

bool hasExtension(const fs::path& path, const std::vector<std::string>& extensions) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

void checkOutputs(const std::vector<Output>& outputs) {
  std::vector<fs::path> seen;
  for (const Output& output : outputs) {
    if (output.path.empty()) continue;
    checkOutput(output);
    const fs::path path = fs::weakly_canonical(output.path);
    if (std::find(seen.begin(), seen.end(), path) != seen.end())
      throw Error(ErrorCode::Usage, output.option + " " + output.path.string() +
                                        ": another option already writes this file; give each its own");
    seen.push_back(path);
  }
}

}  // namespace raymap
