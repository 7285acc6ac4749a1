#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raymap {

/// Kinds of values of an option.
enum class Takes : uint8_t {
  Library,  ///< Values of an option of the library, which raymap/named_options.h describes.
  // Any text:
  Nothing,
  File,
  Files,  ///< Any number of files, which have no option.
  Text,
  Choice,
  // Numbers:
  Bytes,
  Count,      ///< A whole number from 0 on.
  Natural,    ///< A whole number from 1 on.
  Whole,      ///< A whole number from 0 on, of up to 64 bits.
  Number,     ///< Any finite number.
  FromZero,   ///< A number of at least 0.
  AboveZero,  ///< A number above 0.
  Pair,       ///< Two whole numbers from 1 on.
  Triple,     ///< Three whole numbers from 1 on.
  Vector,     ///< Three numbers.
  Lengths,    ///< Three numbers above 0.
  Direction,  ///< Three numbers, or the name of an axis.
  Plane,      ///< Four numbers: the normal, then its product with a point of the plane.
  Corners,    ///< Six numbers: the lowest corner, then the highest.
  List,       ///< Numbers or names with commas between them.
};

/// An option. It means the same in every command that has it.
struct OptionRow {
  const char* name;    ///< As help shows it: "-o,--output".
  const char* others;  ///< Further spellings. Those of a negation begin with !, and help shows them.
  const char* group;   ///< Heading in the help.
  Takes takes = Takes::Library;
  const char* value = nullptr;     ///< Name of the value, which also says its unit; empty for a flag.
  const char* fallback = nullptr;  ///< Default, as help shows it; empty if there is none.
  const char* help = nullptr;
  std::vector<std::string> (*choices)() = nullptr;
};

/// Returns the one description of all options. The parser, the help, docs/cli.md, the completion and the man
/// pages use it.
std::span<const OptionRow> optionRows();

/// Returns the row with this spelling, for example "--color" or "-o"; null if there is none.
const OptionRow* findRow(std::string_view spelling);

/// Options that mean nothing without the second one, in a command that has both. Any one of several will do.
constexpr std::pair<const char*, const char*> kNeeded[] = {
    {"--drain-hole", "--shell"},       {"--down", "--base"},   {"--start-frame", "--frames"},
    {"--down", "--drain-hole"},        {"--index", "--slice"}, {"--fps", "--frames"},
    {"--drain-holes", "--drain-hole"}, {"--clip", "--frames"}};

/// Options that contradict each other.
constexpr std::pair<const char*, const char*> kExclusive[] = {
    {"--voxel-size", "--resolution"}, {"--resolution", "--shape"}, {"--shape", "--align"},
    {"--padding", "--bounds"},        {"--to", "--unit"},          {"--stats", "--json"},
    {"--scale", "--height"},          {"--scale", "--fit"},        {"--height", "--fit"},
    {"--height", "--frames"},         {"--fit", "--frames"},       {"--verbose", "--quiet"}};

/// Returns the number of values that an option takes.
int valueCount(Takes takes);

/// Returns the name that messages use: "--output".
std::string longName(const OptionRow& row);

/// Returns "--close-holes, --no-close-holes" or "-o, --output".
std::string shownNames(const OptionRow& row);

/// Returns all spellings, short ones first: "-r, --resolution, --res".
std::string allSpellings(const OptionRow& row);

/// Returns the help with the default at its end.
std::string helpOf(const OptionRow& row);

/// Returns the spelling of a choice that the program uses: without capitals, in British spelling, and with
/// short names of units.
std::string canonical(std::string_view choice);

}  // namespace raymap
