#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/version.h>

#include <algorithm>
#include <cstdio>
#include <ostream>

#include "checks.h"
#include "commands.h"
#include "report.h"
#include "terminal.h"
#include "text.h"
#include "usage.h"

namespace raymap {

namespace {

/// Returns the names without their commas, as a shell lists them: "-o --output".
std::string listed(const OptionRow& row) {
  return replaced(shownNames(row), ",", "");
}

std::string choicesOf(const OptionRow& row) {
  return row.choices == nullptr ? "" : joined(row.choices(), " ");
}

/// Returns the text without letters that mean something between single quotes, brackets and colons.
std::string quotable(std::string text) {
  for (const char letter : {'\'', '[', ']', ':', '\\'}) std::erase(text, letter);
  return text;
}

std::string completionForBash(const Program& program) {
  std::string choices, options, commands;
  for (const OptionRow& row : optionRows())
    if (row.choices != nullptr)
      choices += "    " + replaced(listed(row), " ", "|") + ") COMPREPLY=($(compgen -W '" + choicesOf(row) +
                 "' -- \"$cur\")); return ;;\n";
  for (const Command& command : program.commands) {
    commands += " " + command.name;
    options += "    " + command.name + ") options='--help";
    for (const Argument& option : command.options) options += " " + listed(option.row);
    options += "' ;;\n";
  }
  return "_raymap() {\n  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} options=''\n"
         "  case $prev in\n" +
         choices + "  esac\n  case ${COMP_WORDS[1]} in\n" + options +
         "  esac\n  if [[ $COMP_CWORD == 1 || ${COMP_WORDS[1]} == help ]]; then\n    COMPREPLY=($(compgen -W "
         "'help" +
         commands +
         "' -- \"$cur\"))\n  elif [[ $cur == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n  else\n"
         "    COMPREPLY=($(compgen -f -- \"$cur\"))\n  fi\n}\ncomplete -o filenames -F _raymap raymap\n";
}

std::string completionForZsh(const Program& program) {
  std::string commands, options;
  for (const Command& command : program.commands) {
    commands += "  '" + command.name + ":" + quotable(command.description) + "'\n";
    options += "  " + command.name + ")\n    _arguments '*:file:_files' \\\n";
    for (const Argument& option : command.options)
      for (const std::string& name : split(listed(option.row), ' ')) {
        options += "      '" + name + "[" + quotable(option.help) + "]";
        const std::string choices = choicesOf(option.row);
        if (*option.row.value != '\0')
          options +=
              ":" + quotable(option.row.value) + ":" + (choices.empty() ? "_files" : "(" + choices + ")");
        options += "' \\\n";
      }
    options += "      '--help[Print this help]' ;;\n";
  }
  return "#compdef raymap\nlocal -a commands=(\n" + commands +
         ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
         "shift words; (( CURRENT-- ))\ncase $words[1] in\n" +
         options + "esac\n";
}

std::string completionForFish(const Program& program) {
  std::string text;
  for (const Command& command : program.commands) {
    const std::string name = command.name;
    text += "complete -c raymap -n __fish_use_subcommand -f -a " + name + " -d '" +
            quotable(command.description) + "'\n";
    for (const Argument& option : command.options) {
      text += "complete -c raymap -n '__fish_seen_subcommand_from " + name + "'";
      for (const std::string& each : split(listed(option.row), ' '))
        text += each.starts_with("--") ? " -l " + each.substr(2) : " -s " + each.substr(1);
      if (const std::string choices = choicesOf(option.row); !choices.empty())
        text += " -x -a '" + choices + "'";
      else if (*option.row.value != '\0')
        text += " -r";
      text += " -d '" + quotable(option.help) + "'\n";
    }
  }
  return text;
}

/// Returns a text as roff takes it.
std::string roff(std::string text) {
  text = replaced(text, "\\", "\\e");
  text = replaced(text, "-", "\\-");
  text = replaced("\n" + text, "\n.", "\n\\&.");
  return replaced(text, "\n'", "\n\\&'").substr(1);
}

/// Returns paragraphs, and lines with blanks before them as they are.
std::string roffOfFooter(const std::string& footer) {
  std::string text;
  for (const auto& [indent, line] : footerLines(footer))
    if (indent > 0)
      text += ".nf\n" + std::string(indent, ' ') + roff(line) + "\n.fi\n";
    else
      text += line.empty() ? ".PP\n" : roff(line) + "\n";
  return text;
}

std::string nameOfPage(const Command& command) {
  return command.name.empty() ? "raymap" : "raymap-" + command.name;
}

/// Returns the man page of a command, or of the program.
std::string manPage(const Program& program, const Command& command) {
  const bool isProgram = command.name.empty();
  const std::string name = nameOfPage(command);
  std::string text = ".TH " + replaced(name, "-", "\\-") + " 1 \"\" \"raymap " + version().text +
                     "\"\n.SH NAME\n" + roff(name) + " \\- " + roff(command.description) +
                     "\n.SH SYNOPSIS\n.B raymap " + (isProgram ? "COMMAND" : command.name);
  for (const Argument& each : command.operands) text += " " + each.shown();
  text += isProgram ? "\n.SH COMMANDS\n" : " [OPTIONS]\n.SH OPTIONS\n";
  if (isProgram)
    for (const Command& each : program.commands)
      text += ".TP\n.B " + each.name + "\n" + roff(each.description) + "\n";
  for (const Argument& each : command.operands)
    text += ".TP\n.I " + each.shown() + "\n" + roff(each.help) + "\n";
  for (const Argument& each : command.options)
    text += ".TP\n.B " + roff(allSpellings(each.row) + " " + each.row.value) + "\n" + roff(each.help) + "\n";
  return text + ".SH NOTES\n" + roffOfFooter(command.footer);
}

/// Returns the options over the commands, as docs/dev/option_table.md has them.
std::string tableOf(const Program& program) {
  std::string text = "| option | also written | value | default | commands |\n|---|---|---|---|---|\n";
  for (const OptionRow& row : optionRows()) {
    std::string also, commands;
    const std::vector<std::string> shown = split(listed(row), ' ');
    for (std::string other : split(row.others, ',')) {
      if (other.starts_with('!')) other.erase(0, 1);
      if (!other.empty() && std::ranges::count(shown, other) == 0)
        also += (also.empty() ? "`" : ", `") + other + "`";
    }
    size_t count = 0;
    for (const Command& command : program.commands) {
      if (command.find(longName(row)) == nullptr) continue;
      commands += (commands.empty() ? "" : ", ") + command.name;
      ++count;
    }
    if (count == 0) continue;
    if (count == program.commands.size()) commands = "all";
    text += "| `" + replaced(shownNames(row), ", ", "`, `") + "`";
    for (const std::string& cell : {also, std::string(row.value), std::string(row.fallback), commands})
      text.append(" | ").append(cell);
    text += " |\n";
  }
  return text;
}

struct ManualArguments {
  std::string what;
  std::filesystem::path output;
  bool isTable = false;
};

void write(const ManualArguments& arguments, const std::string& text) {
  if (arguments.output.empty() || arguments.output == "-") {
    std::fputs(text.c_str(), stdout);
    return;
  }
  writeAtomically(arguments.output, [&](std::ostream& out) { out << text; });
  silenceText();
  printWritten(arguments.output);
}

void runManual(const Program& program, const ManualArguments& arguments) {
  if (arguments.isTable) {
    write(arguments, tableOf(program));
    return;
  }
  const Command* page = arguments.what.empty() ? &program : nullptr;
  for (const Command& command : program.commands)
    if (command.name == arguments.what) page = &command;
  if (page == nullptr)
    throw Error(ErrorCode::Usage, "there is no command " + arguments.what + "; see raymap --help");
  if (!std::filesystem::is_directory(arguments.output)) return write(arguments, manPage(program, *page));
  std::vector<const Command*> pages{page};
  if (page == &program)
    for (const Command& command : program.commands) pages.push_back(&command);
  silenceText();
  for (const Command* each : pages)
    write({.output = arguments.output / (nameOfPage(*each) + ".1")}, manPage(program, *each));
}

}  // namespace

void addCompletion(Program& program) {
  Command& command = program.addCommand(
      "completion", "Print a shell completion script for commands and options",
      "Examples:\n  source <(raymap completion bash)\n  raymap completion zsh -o ~/.zfunc/_raymap\n"
      "  raymap completion fish -o ~/.config/fish/completions/raymap.fish");
  const auto arguments = std::make_shared<ManualArguments>();
  const auto choose = [arguments](const std::string& text) {
    arguments->what = chosen({"bash", "zsh", "fish"}, text);
  };
  addOperand(command, "SHELL", choose, "Shell: bash, zsh or fish");
  addOutput(command, arguments->output, "Script to write; without it, it is printed");
  command.run = [&program, arguments] {
    const auto make = arguments->what == "bash"  ? completionForBash
                      : arguments->what == "zsh" ? completionForZsh
                                                 : completionForFish;
    write(*arguments, make(program));
  };
}

void addManual(Program& program) {
  Command& command =
      program.addCommand("manual", "Print the man page of the program, or of a command",
                         "Examples:\n  raymap manual repair | man -l -\n  raymap manual -o man/man1");
  const auto arguments = std::make_shared<ManualArguments>();
  addOperand(command, "COMMAND", &arguments->what, "Command to describe").isRequired = false;
  addOutput(command, arguments->output,
            "Page to write; without it, it is printed. In a folder it is raymap.1 or raymap-COMMAND.1, and "
            "without COMMAND all pages are written there");
  addOptions(command, {{"--table", &arguments->isTable}});
  command.run = [&program, arguments] { runManual(program, *arguments); };
}

}  // namespace raymap
