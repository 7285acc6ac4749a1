#include "parser.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <stdexcept>
#include <type_traits>

#include "checks.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace {

/// Returns whether a word is an option, and not a file or a negative number.
bool isOption(const std::string& word) {
  const size_t digit = word.starts_with("-.") ? 2 : 1;
  return word.size() > 1 && word[0] == '-' &&
         (digit == word.size() || std::isdigit(static_cast<unsigned char>(word[digit])) == 0);
}

/// Returns the numbers of an axis such as "z" or "-X"; none if it is no axis.
std::vector<std::string> directionOf(std::string_view text) {
  const bool isSigned = text.size() == 2 && (text[0] == '-' || text[0] == '+');
  const size_t axis = std::string_view("xyz").find(lower(text.substr(isSigned ? 1 : 0)));
  if (text.size() != (isSigned ? 2 : 1) || axis == std::string_view::npos) return {};
  std::vector<std::string> direction(3, "0");
  direction[axis] = text[0] == '-' ? "-1" : "1";
  return direction;
}

/// Returns whether an argument takes any number of values.
bool takesMany(const OptionRow& row) {
  return row.takes == Takes::List || row.takes == Takes::Files;
}

/// Returns whether a word is one of the numbers or names that a list takes.
bool isOneOf(const OptionRow& row, const std::string& word) {
  return row.choices == nullptr ? numberIn(word).has_value()
                                : std::ranges::count(row.choices(), canonical(word)) > 0;
}

/// Reads the words of a command one after another.
class Reader {
 public:
  Reader(Command& command, std::vector<std::string> words, Parsed& parsed)
      : command_(command), words_(std::move(words)), parsed_(parsed) {}

  void read() {
    bool hasEnded = false;  // At "--".
    while (!isAtEnd()) {
      const std::string word = words_[at_++];
      const bool isLong = word.starts_with("--");
      const size_t end = std::min(isLong ? word.find('=') : 2, word.size());
      const std::string name = isLong ? lower(word.substr(0, end)) : word.substr(0, end);
      if (hasEnded || !isOption(word))
        readOperand(word);
      else if (word == "--")
        hasEnded = true;
      else if (!readOption(name, word.substr(std::min(isLong ? end + 1 : end, word.size()))))
        parsed_.unknown.push_back(name + word.substr(end));
    }
  }

 private:
  bool isAtEnd() const { return at_ == words_.size(); }
  void insert(const std::string& word) { words_.insert(words_.begin() + ptrdiff_t(at_), word); }

  void blame(const std::string& mistake) {
    if (parsed_.mistake.empty()) parsed_.mistake = mistake;
  }

  void readOperand(const std::string& word) {
    for (Argument& each : command_.operands)
      if (each.given.empty() || takesMany(each.row)) return each.given.push_back(word);
    parsed_.unknown.push_back(word);
  }

  /// Reads an option. `rest` is what stands in the same word: of -r64, -vj2 or --res=64. Returns whether the
  /// command has the option.
  bool readOption(const std::string& name, const std::string& rest) {
    if (name == "-h" || name == "--help") return parsed_.isHelp = true;
    auto* option = const_cast<Argument*>(command_.find(name));
    if (option == nullptr) return false;
    if (option->row.takes == Takes::Nothing) {
      option->given = {std::ranges::count(split(option->row.others, ','), "!" + name) > 0 ? "false" : "true"};
      if (!rest.empty() && name.size() == 2)
        insert("-" + rest);
      else if (!rest.empty() && rest != option->given[0])
        blame(longName(option->row) + " takes no value");
      return true;
    }
    if (!rest.empty()) insert(rest);
    if (valueCount(option->row.takes) > 2)
      readNumbers(*option);
    else
      readValues(*option);
    return true;
  }

  void readValues(Argument& option) {
    const bool isOptional = option.row.value[0] == '[';
    const auto isNext = [&](int count) {
      if (isAtEnd()) return false;
      if (count < valueCount(option.row.takes)) return !isOption(words_[at_]) || (count == 0 && !isOptional);
      return takesMany(option.row) && isOneOf(option.row, words_[at_]);
    };
    int count = 0;
    for (; isNext(count); ++count) option.given.push_back(words_[at_++]);
    if (count == 0 && isOptional) return option.given.emplace_back(), void();
    if (count < valueCount(option.row.takes))
      blame(longName(option.row) + " needs a value: " + option.shown());
  }

  /// Reads numbers with commas or blanks between them, or the name of an axis.
  void readNumbers(Argument& option) {
    const OptionRow& row = option.row;
    const int wanted = valueCount(row.takes);
    int taken = 0;
    for (; taken < wanted && !isAtEnd(); ++at_) {
      std::vector<std::string> parts = wordsOf(replaced(words_[at_], ",", " "));
      if (row.takes == Takes::Direction && taken == 0 && parts.size() == 1)
        if (const auto direction = directionOf(parts[0]); !direction.empty()) parts = direction;
      if (!std::ranges::all_of(parts, [](const auto& part) { return numberIn(part).has_value(); })) break;
      option.given.insert(option.given.end(), parts.begin(), parts.end());
      taken += int(parts.size());
    }
    if (taken == wanted) return;
    throw Error(ErrorCode::Usage, shownNames(row) + " takes " + std::to_string(wanted) + " numbers" +
                                      (row.takes == Takes::Direction ? ", or an axis such as z or -y" : "") +
                                      ", and here are " + std::to_string(taken) +
                                      (taken < wanted && !isAtEnd() ? " before " + words_[at_] : ""));
  }

  Command& command_;
  std::vector<std::string> words_;
  size_t at_ = 0;
  Parsed& parsed_;
};

/// Sets a variable to a value, or appends it to a vector.
template <class Variable>
void set(Variable& variable, const std::string& text) {
  if constexpr (requires { variable.emplace_back(); })
    set(variable.emplace_back(), text);
  else if constexpr (requires { variable.emplace(); })
    set(variable.emplace(), text);
  else if constexpr (std::is_same_v<Variable, bool>)
    variable = text == "true";
  else if constexpr (std::is_arithmetic_v<Variable>)
    variable = Variable(std::strtold(text.c_str(), nullptr));
  else
    variable = text;
}

/// Sets the variable of an argument. Returns what is wrong with its values.
std::string store(Argument& argument) {
  std::vector<std::string> values = argument.given;
  if (argument.row.takes == Takes::List) values = wordsOf(replaced(joined(values, " "), ",", " "));
  try {
    for (std::string& value : values) value = checkedValue(argument.row, value);
    std::visit(
        [&](auto& target) {
          if constexpr (requires { target->clear(); }) target->clear();
          for (const std::string& value : values)
            if constexpr (requires { *target; })
              set(*target, value);
            else
              target(value);
        },
        argument.target);
  } catch (const Error& error) {
    return lower(longName(argument.row)) + ": " + error.what();
  }
  const bool isRepeated =
      !takesMany(argument.row) && values.size() > size_t(std::max(valueCount(argument.row.takes), 1));
  return isRepeated ? longName(argument.row) + " is given more than once; leave all but one out" : "";
}

/// Returns what is wrong with an option beside the others of the command.
std::string mistakeBeside(const Command& command, const Argument& argument) {
  if (argument.given.empty()) return argument.isRequired ? argument.shown() + " is required" : "";
  const std::string name = longName(argument.row);
  std::string needed;
  bool isMet = false;
  for (const auto& [option, other] : kNeeded) {
    if (name != option || command.find(other) == nullptr) continue;
    isMet |= command.isGiven(other);
    needed += (needed.empty() ? "" : " or ") + command.find(other)->shown();
  }
  if (!isMet && !needed.empty()) return name + " needs " + needed + "; add it";
  for (const auto& [option, other] : kExclusive)
    if ((name == option && command.isGiven(other)) || (name == other && command.isGiven(option)))
      return std::string(option) + " and " + other + " cannot be used together; leave one of them out";
  return "";
}

/// Throws `std::logic_error` if a variable differs from the default that help shows.
void checkDefault(const OptionRow& row, const Target& target) {
  const auto differs = [&](const auto& variable) {
    if constexpr (requires { double(*variable); })
      return numberIn(row.fallback).value_or(double(*variable)) != double(*variable);
    else if constexpr (requires { *variable == row.fallback; })
      return !variable->empty() && *variable != row.fallback;
    else
      return false;
  };
  if (std::visit(differs, target))
    throw std::logic_error(std::string(row.name) + ": the default is not " + row.fallback);
}

}  // namespace

std::string Argument::shown() const {
  return longName(row) + (row.value[0] == '\0' ? "" : " ") + row.value;
}

const Argument* Command::find(std::string_view spelling) const {
  const OptionRow* row = findRow(spelling);
  const auto found = std::ranges::find_if(
      options, [&](const Argument& each) { return row != nullptr && each.row.name == row->name; });
  return found == options.end() ? nullptr : &*found;
}

bool Command::isGiven(std::string_view spelling) const {
  const Argument* option = find(spelling);
  return option != nullptr && !option->given.empty();
}

Command& Program::addCommand(const char* word, const char* text, const char* notes) {
  return commands.emplace_back(Command{.name = word, .description = text, .footer = notes});
}

Argument& addOperand(Command& command, const char* name, Target target, const char* help) {
  const bool isMany = std::holds_alternative<std::vector<std::filesystem::path>*>(target);
  return command.operands.emplace_back(Argument{
      {name, "", "", isMany ? Takes::Files : Takes::File, "", "", help}, help, std::move(target), true});
}

void addOptions(Command& command, std::initializer_list<std::pair<const char*, Target>> options) {
  for (const auto& [name, target] : options) {
    const OptionRow* row = findRow(name);
    if (row == nullptr) throw std::logic_error(std::string(name) + ": options.cpp has no such row");
    checkDefault(*row, target);
    command.options.push_back({*row, helpOf(*row), target});
  }
}

Argument& addOutput(Command& command, std::filesystem::path& path, const std::string& what,
                    const std::vector<std::string>& extensions) {
  addOptions(command, {{"--output", &path}});
  command.options.back().help = what + (extensions.empty() ? "" : ": ") + joined(extensions, ", ", " or ");
  return command.options.back();
}

void addFigureOptions(Command& command, std::filesystem::path& stats) {
  addOptions(command, {{"--json", [&](const std::string&) { stats = "-"; }}, {"--stats", &stats}});
}

void addJsonOption(Command& command, bool& isJson) {
  addOptions(command, {{"--json", [&](const std::string&) { isJson = true, keepText(); }}});
}

void parse(Command& command, std::vector<std::string> words, Parsed& parsed) {
  Reader(command, std::move(words), parsed).read();
  for (auto* arguments : {&command.operands, &command.options})
    for (Argument& each : *arguments)
      if (parsed.mistake.empty() && !each.given.empty()) parsed.mistake = store(each);
  for (auto* arguments : {&command.operands, &command.options})
    for (const Argument& each : *arguments)
      if (parsed.mistake.empty() && !parsed.isHelp) parsed.mistake = mistakeBeside(command, each);
}

Parsed parse(Program& program, std::vector<std::string> words) {
  constexpr std::array kAnywhere{"-q", "--quiet", "-v", "--verbose", "--progress"};
  auto first = words.begin();
  while (first != words.end() && std::ranges::count(kAnywhere, lower(first->substr(0, first->find('=')))) > 0)
    first += lower(*first) == "--progress" && first + 1 != words.end() ? 2 : 1;
  std::rotate(words.begin(), first, words.end());
  if (!words.empty() && lower(words.front()) == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  Parsed parsed;
  for (auto word = words.begin(); word != words.end() && parsed.command == nullptr; ++word) {
    const auto command = std::ranges::find(program.commands, lower(*word), &Command::name);
    if (command != program.commands.end()) {
      parsed.command = &*command;
      parse(*command, {word + 1, words.end()}, parsed);
    } else {
      parsed.isHelp |= *word == "-h" || lower(*word) == "--help";
      parsed.isVersion |= *word == "-V" || lower(*word) == "--version";
      parsed.unknown.push_back(*word);
    }
  }
  return parsed;
}

}  // namespace raymap
