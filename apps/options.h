#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace raymap {

/// Kinds of values of an option.
enum class Takes : uint8_t {
  Nothing,
  File,
  Text,
  Choice,
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
  Takes takes;
  const char* value;     ///< Name of the value, which also says its unit; empty for a flag.
  const char* fallback;  ///< Default, as help shows it; empty if there is none.
  const char* help;
  std::vector<std::string> (*choices)() = nullptr;
};

/// Returns the one description of all options. CLI11's options, the help, docs/cli.md, the completion and the
/// man pages are made of it.
std::span<const OptionRow> optionRows();

/// Returns the row with this spelling, for example "--color" or "-o"; null if there is none.
const OptionRow* findRow(std::string_view spelling);

/// Returns the number of values that an option takes.
int valueCount(Takes takes);

/// Returns "--close-holes, --no-close-holes" or "-o, --output".
std::string shownNames(const OptionRow& row);

/// Returns all spellings, short ones first: "-r, --resolution, --res".
std::string allSpellings(const OptionRow& row);

/// Returns the help with the default at its end.
std::string helpOf(const OptionRow& row);

/// Returns the spelling of a choice that the program uses: without capitals, in British spelling, and with
/// short names of units.
std::string canonical(std::string_view choice);

namespace detail {
std::string allNames(const OptionRow& row);
const OptionRow& rowNamed(const char* name);
CLI::Option* describe(CLI::Option* option, const OptionRow& row);
void checkDefault(const OptionRow& row, double value);
void checkDefault(const OptionRow& row, const std::string& value);
}  // namespace detail

/// Accepts one of these choices, in any spelling that `canonical` knows.
CLI::Validator oneOf(std::vector<std::string> choices);

/// Adds the option with this name. A flag for a bool, else an option with a value. Throws `std::logic_error`
/// if there is no such row, or if the value differs from the row's default.
template <class Value>
CLI::Option* addOption(CLI::App& command, const char* name, Value& value) {
  const OptionRow& row = detail::rowNamed(name);
  if constexpr (std::is_same_v<Value, bool>)
    return detail::describe(command.add_flag(detail::allNames(row), value), row);
  else {
    if constexpr (std::is_arithmetic_v<Value>) detail::checkDefault(row, double(value));
    if constexpr (std::is_same_v<Value, std::string>) detail::checkDefault(row, value);
    return detail::describe(command.add_option(detail::allNames(row), value), row);
  }
}

/// Adds `--output`, with what this command writes there: "Mesh to write: .ply, .obj or .stl".
CLI::Option* addOutput(CLI::App& command, std::filesystem::path& path, const std::string& what,
                       const std::vector<std::string>& extensions = {});

/// Adds the options for the text that a command prints, which every command has.
void addTextOptions(CLI::App& command);

/// Adds `--stats` and `--json`, which writes the same to stdout.
void addFigureOptions(CLI::App& command, std::filesystem::path& stats);

/// Adds `--json` of a command whose text is its result.
void addJsonOption(CLI::App& command, bool& isJson);

/// Returns the arguments as CLI11 reads them. Splits the numbers of an option that takes several, and
/// replaces an axis by its direction. Throws `Error(Usage)` if such an option has too few.
std::vector<std::string> normalized(std::span<const std::string> arguments);

}  // namespace raymap
