#include "sequence.h"

#include <raymap/error.h>
#include <raymap/io.h>

#include <array>
#include <charconv>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "checks.h"
#include "field_array.h"
#include "parser.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

Box shapeBounds(const Mesh& mesh) {
  return gridBounds(mesh);
}

/// Returns the bounds of the surface; of the grid, if the file does not tell them.
Box shapeBounds(const Field& field) {
  if (!field.surfaceBounds.isEmpty()) return field.surfaceBounds;
  return boxOf(field.grid);
}

}  // namespace

void addFrameOptions(Command& command, FrameArguments& arguments) {
  addOptions(command, {{"--frames", &arguments.frames},
                       {"--fps", &arguments.fps},
                       {"--start-frame", &arguments.start},
                       {"--clip", &arguments.clip}});
}

namespace {

/// Place of the frame number in a name.
struct Place {
  size_t begin, length, digits;
};

/// Returns the places of a kind: %d or %04d, $F or $F4, or rows of #.
std::vector<Place> placesOf(const std::string& name, const std::regex& kind) {
  std::vector<Place> places;
  for (auto match = std::sregex_iterator(name.begin(), name.end(), kind); match != std::sregex_iterator();
       ++match) {
    const std::string digits = (*match)[1].str();
    const size_t length = size_t(match->length());
    places.push_back({size_t(match->position()), length,
                      digits.empty()     ? 0
                      : digits[0] == '#' ? length
                                         : size_t(digits.back() - '0')});
  }
  return places;
}

/// Returns the places in a name. Where it has one of a kind, those of the next kinds are text.
std::vector<Place> placesOf(const std::string& name) {
  static const std::array kKinds{std::regex("%(0[0-9])?d"), std::regex("\\$F([1-9])?"), std::regex("(#)#*")};
  for (const std::regex& kind : kKinds)
    if (std::vector<Place> places = placesOf(name, kind); !places.empty()) return places;
  return {};
}

/// Returns whether a file is named by a pattern.
bool isNumbered(const fs::path& input) {
  const std::string name = input.filename().string();
  return name.find('%') != std::string::npos || (!placesOf(name).empty() && !fs::exists(input));
}

}  // namespace

fs::path framePath(const fs::path& pattern, int frame) {
  std::string name = pattern.filename().string();
  const std::vector<Place> places = placesOf(name);
  const bool isPlain =
      name.find('%') == std::string::npos || (places.size() == 1 && name[places[0].begin] == '%' &&
                                              name.find('%', places[0].begin + 1) == std::string::npos);
  if (places.size() != 1 || !isPlain)
    throw Error(
        ErrorCode::Usage,
        displayName(pattern) +
            ": with --frames a name holds the number of the frame once, as %d, %04d, $F4 or ####" +
            (pattern.has_extension() ? ": " + pattern.stem().string() + ".%04d" + pattern.extension().string()
                                     : ""));
  const auto [begin, length, digits] = places[0];
  std::string number = std::to_string(frame);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return pattern.parent_path() / name.replace(begin, length, number);
}

Sequence::Sequence(const FrameArguments& arguments, const fs::path& input, const std::string& format,
                   const MeshUnits& units, bool allowEmpty, const std::string& grid)
    : start_(arguments.start),
      fps_(arguments.fps),
      input_(input),
      format_(format),
      grid_(grid),
      units_(units),
      allowEmpty_(allowEmpty) {
  parse(arguments.frames);
  if (!isNumbered(input) && hasExtension(input, {".gltf", ".glb"})) {
    const WaitingLine line("reading " + displayName(input.filename()));
    animated_ = readAnimatedMesh(input, arguments.clip, {.warn = warn});
    warnOfEnd();
    return;
  }
  if (!isNumbered(input))
    throw Error(ErrorCode::Usage, displayName(input) +
                                      ": --frames takes an animated .gltf or .glb, or numbered files such "
                                      "as " +
                                      input.stem().string() + ".%04d" + input.extension().string());
  if (!arguments.clip.empty() || arguments.start != 0)
    throw Error(ErrorCode::Usage, std::string(arguments.clip.empty() ? "--start-frame" : "--clip") +
                                      " is for an animated .gltf or .glb; leave it out for numbered files");
  for (size_t i = 0; i < size_; ++i)
    if (!fs::exists(this->input(i)))
      throw Error(ErrorCode::File, displayName(this->input(i)) + ": there is no such file, and --frames " +
                                       arguments.frames + " asks for it");
}

/// Reads FIRST, FIRST:LAST or FIRST:LAST:STEP.
void Sequence::parse(const std::string& frames) {
  std::vector<int> numbers;
  const char *at = frames.data(), *end = at + frames.size();
  for (bool isMore = true; isMore;) {
    int number = -1;
    const auto [rest, error] = std::from_chars(at, end, number);
    isMore = error == std::errc() && rest != end && *rest == ':';
    numbers.push_back(error == std::errc() && (rest == end || isMore) ? number : -1);
    at = isMore ? rest + 1 : rest;
  }
  const int last = numbers.size() > 1 ? numbers[1] : numbers[0];
  first_ = numbers[0];
  step_ = numbers.size() > 2 ? numbers[2] : 1;
  if (numbers.size() > 3 || first_ < 0 || last < first_ || step_ < 1)
    throw Error(ErrorCode::Usage,
                "--frames " + frames +
                    ": must be FIRST:LAST or FIRST:LAST:STEP, whole numbers from 0 on, LAST not below "
                    "FIRST, STEP from 1 on");
  size_ = size_t(last - first_) / size_t(step_) + 1;
}

void Sequence::warnOfEnd() const {
  const int last = start_ + int(std::floor(std::min(animated_->seconds() * fps_, 1e9) + 1e-6));
  if (frame(size_ - 1) <= last) return;
  printWarning(displayName(input_) + ": the clip ends with frame " + std::to_string(last) +
               "; later ones keep its last pose");
}

fs::path Sequence::input(size_t i) const {
  return animated_ ? input_ : framePath(input_, frame(i));
}

std::string Sequence::title(size_t i) const {
  return "frame " + std::to_string(frame(i)) + " of " + std::to_string(first_) + " to " +
         std::to_string(frame(size_ - 1)) + ": ";
}

/// Returns the animation's pose. Its numbers are finite, but their product may not be.
Mesh Sequence::pose(size_t i) const {
  Mesh mesh = posed(*animated_, seconds(i));
  try {
    validate(mesh);
  } catch (const Error& error) {
    throw Error(error.code(),
                displayName(input_) + ": frame " + std::to_string(frame(i)) + ": " + error.what());
  }
  return mesh;
}

std::variant<Mesh, Field> Sequence::read(size_t i) {
  const fs::path path = named(input(i), format_);
  std::variant<Mesh, Field> result;
  if (animated_)
    result = pose(i);
  else
    result = raymap::read(input(i), {.format = format_,
                                     .warn = i < seen_ ? WarningCallback() : warn,
                                     .allowEmpty = allowEmpty_,
                                     .gridName = grid_});
  seen_ = std::max(seen_, i + 1);
  std::visit([&](auto& shape) { convertUnits(shape, units_, path); }, result);
  // `convertUnits` says which unit it supposes. Named from then on, it is not said of each frame.
  if (units_.from.empty() && !meshUnit(path)) units_.from = units_.unit;
  return result;
}

Box Sequence::bounds() {
  const WaitingLine line("finding the bounds of all frames");
  Box all;
  for (size_t i = 0; i < size_; ++i) {
    const std::variant<Mesh, Field> shape = read(i);
    const Box box = std::visit([](const auto& each) { return shapeBounds(each); }, shape);
    all.min = glm::min(all.min, box.min);
    all.max = glm::max(all.max, box.max);
  }
  return all;
}

}  // namespace raymap
