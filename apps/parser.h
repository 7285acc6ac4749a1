#pragma once

// Reads command lines. options.h says what each option takes; a command says which options it has, and which
// variables they set.

#include <deque>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "options.h"

namespace raymap {

/// Variable that an argument sets, or a function that is called with its value.
using Target =
    std::variant<bool*, int*, size_t*, double*, std::string*, std::filesystem::path*, std::optional<int>*,
                 std::optional<double>*, std::vector<int>*, std::vector<double>*, std::vector<std::string>*,
                 std::vector<std::filesystem::path>*, std::function<void(const std::string&)>>;

/// An option of a command, or an operand: a value that stands without the name of an option.
struct Argument {
  OptionRow row;
  std::string help;
  Target target;
  bool isRequired = false;
  std::vector<std::string> given = {};  ///< Values on the command line; "true" or "false" for a flag.

  /// Returns "--output FILE", or "MESH".
  std::string shown() const;
};

/// A command of the program. Its operands and options stand in the order of the help.
struct Command {
  std::string name, description, footer;
  std::deque<Argument> operands = {}, options = {};
  std::function<void()> prepare = {}, run = {};  ///< Called one after the other.

  /// Returns the option with this spelling; null if the command has none.
  const Argument* find(std::string_view spelling) const;
  bool isGiven(std::string_view spelling) const;

  /// Returns the variables that arguments set. The command will call `work` with them.
  template <class Variables>
  Variables& runs(void (*work)(Variables&)) {
    const auto variables = std::make_shared<Variables>();
    run = [=] { work(*variables); };
    return *variables;
  }
};

/// All commands. It has the description and the footer of a command without a name.
struct Program : Command {
  std::deque<Command> commands;

  Command& addCommand(const char* name, const char* description, const char* footer);
};

/// Adds an operand, which is required. One that sets a vector takes all that are left.
Argument& addOperand(Command& command, const char* name, Target target, const char* help);

/// Adds options by their names, with the variables that they set. Throws `std::logic_error` if there is no
/// such row, or if a variable differs from the row's default.
void addOptions(Command& command, std::initializer_list<std::pair<const char*, Target>> options);

/// Adds `--output`, with what this command writes there: "Mesh to write: .ply, .obj or .stl".
Argument& addOutput(Command& command, std::filesystem::path& path, const std::string& what,
                    const std::vector<std::string>& extensions = {});

/// Adds `--stats` and `--json`, which writes the same to stdout.
void addFigureOptions(Command& command, std::filesystem::path& stats);

/// Adds `--json` of a command whose text is its result.
void addJsonOption(Command& command, bool& isJson);

/// A command line that was read.
struct Parsed {
  Command* command = nullptr;
  bool isHelp = false, isVersion = false;
  std::vector<std::string> unknown;  ///< Words that no argument takes.
  std::string mistake;               ///< First mistake in the known words; empty without one.
};

/// Reads the words that follow a command, and sets its variables. Throws `Error(Usage)` if an option has too
/// few numbers.
void parse(Command& command, std::vector<std::string> words, Parsed& parsed);

/// Reads a command line. Options that every command has may stand before its name, and `help COMMAND` stands
/// for `COMMAND --help`.
Parsed parse(Program& program, std::vector<std::string> words);

}  // namespace raymap
