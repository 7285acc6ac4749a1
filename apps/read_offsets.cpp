#include "read_offsets.h"

#include <raymap/error.h>

#include <charconv>
#include <fstream>
#include <sstream>
#include <string>

namespace raymap {

namespace {

[[noreturn]] void refuseLine(const std::filesystem::path& path, size_t line, const std::string& what) {
  throw Error(ErrorCode::Input, path.string() + ":" + std::to_string(line) + ": " + what +
                                    "; a line holds an offset x y z, three whole numbers of samples");
}

}  // namespace

std::vector<glm::ivec3> readOffsets(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path))
    throw Error(ErrorCode::File, path.string() + ": cannot be opened; check the path and its permissions");
  std::vector<glm::ivec3> offsets;
  std::string text;
  for (size_t line = 1; std::getline(file, text); ++line) {
    std::istringstream words(text.substr(0, text.find('#')));
    std::vector<int> numbers;
    for (std::string word; words >> word;) {
      const char* const end = word.data() + word.size();
      const auto [next, error] = std::from_chars(word.data(), end, numbers.emplace_back());
      if (error != std::errc() || next != end)
        refuseLine(path, line,
                   "number " + std::to_string(numbers.size()) + " is not a whole number of 32 bits");
    }
    if (numbers.empty()) continue;
    if (numbers.size() != 3) refuseLine(path, line, std::to_string(numbers.size()) + " numbers");
    offsets.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  if (file.bad()) throw Error(ErrorCode::File, path.string() + ": cannot be read to its end");
  if (offsets.empty()) throw Error(ErrorCode::Input, path.string() + ": it holds no offsets");
  return offsets;
}

}  // namespace raymap
