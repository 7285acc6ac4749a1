#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/version.h>

#include <algorithm>
#include <cstdio>
#include <ostream>

#include "checks.h"
#include "commands.h"
#include "options.h"
#include "report.h"
#include "terminal.h"
#include "usage.h"

namespace raymap {

namespace {

using Options = std::vector<const OptionRow*>;

std::vector<const CLI::App*> commandsIn(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Returns the rows of the options that a command has, in the order of its help.
Options optionsOf(const CLI::App& command) {
  Options rows;
  for (const CLI::Option* option : command.get_options())
    if (const OptionRow* row = option->get_positional() ? nullptr : findRow(option->get_name()))
      rows.push_back(row);
  return rows;
}

/// Returns the names without their commas, as a shell lists them: "-o --output".
std::string listed(const OptionRow& row) {
  return CLI::detail::find_and_replace(shownNames(row), ",", "");
}

/// Returns the help of an option in a command: that of `--output` differs.
std::string helpIn(const CLI::App& command, const OptionRow& row) {
  return command.get_option(CLI::detail::split(row.name, ',').back())->get_description();
}

std::string choicesOf(const OptionRow& row) {
  return row.choices == nullptr ? "" : CLI::detail::join(row.choices(), " ");
}

/// Returns the text without letters that mean something between single quotes, brackets and colons.
std::string quotable(std::string text) {
  for (const char letter : {'\'', '[', ']', ':', '\\'}) std::erase(text, letter);
  return text;
}

std::string completionForBash(const CLI::App& app) {
  std::string choices, options, commands;
  for (const OptionRow& row : optionRows())
    if (row.choices != nullptr)
      choices += "    " + CLI::detail::find_and_replace(listed(row), " ", "|") +
                 ") COMPREPLY=($(compgen -W '" + choicesOf(row) + "' -- \"$cur\")); return ;;\n";
  for (const CLI::App* command : commandsIn(app)) {
    commands += " " + command->get_name();
    options += "    " + command->get_name() + ") options='--help";
    for (const OptionRow* row : optionsOf(*command)) options += " " + listed(*row);
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

std::string completionForZsh(const CLI::App& app) {
  std::string commands, options;
  for (const CLI::App* command : commandsIn(app)) {
    commands += "  '" + command->get_name() + ":" + quotable(command->get_description()) + "'\n";
    options += "  " + command->get_name() + ")\n    _arguments '*:file:_files' \\\n";
    for (const OptionRow* row : optionsOf(*command))
      for (const std::string& name : CLI::detail::split_up(listed(*row))) {
        options += "      '" + name + "[" + quotable(helpIn(*command, *row)) + "]";
        const std::string choices = choicesOf(*row);
        if (*row->value != '\0')
          options += ":" + quotable(row->value) + ":" + (choices.empty() ? "_files" : "(" + choices + ")");
        options += "' \\\n";
      }
    options += "      '--help[Print this help]' ;;\n";
  }
  return "#compdef raymap\nlocal -a commands=(\n" + commands +
         ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
         "shift words; (( CURRENT-- ))\ncase $words[1] in\n" +
         options + "esac\n";
}

std::string completionForFish(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : commandsIn(app)) {
    const std::string name = command->get_name();
    text += "complete -c raymap -n __fish_use_subcommand -f -a " + name + " -d '" +
            quotable(command->get_description()) + "'\n";
    for (const OptionRow* row : optionsOf(*command)) {
      text += "complete -c raymap -n '__fish_seen_subcommand_from " + name + "'";
      for (const std::string& each : CLI::detail::split_up(listed(*row)))
        text += each.starts_with("--") ? " -l " + each.substr(2) : " -s " + each.substr(1);
      if (const std::string choices = choicesOf(*row); !choices.empty())
        text += " -x -a '" + choices + "'";
      else if (*row->value != '\0')
        text += " -r";
      text += " -d '" + quotable(helpIn(*command, *row)) + "'\n";
    }
  }
  return text;
}

/// Returns a text as roff takes it.
std::string roff(std::string text) {
  text = CLI::detail::find_and_replace(text, "\\", "\\e");
  text = CLI::detail::find_and_replace(text, "-", "\\-");
  text = CLI::detail::find_and_replace("\n" + text, "\n.", "\n\\&.");
  return CLI::detail::find_and_replace(text, "\n'", "\n\\&'").substr(1);
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

std::string nameOfPage(const CLI::App& app, const CLI::App& command) {
  return &app == &command ? "raymap" : "raymap-" + command.get_name();
}

/// Returns the man page of the program, or of a command.
std::string manPage(const CLI::App& app, const CLI::App& command) {
  const bool isProgram = &app == &command;
  const std::string name = nameOfPage(app, command);
  std::string text = ".TH " + CLI::detail::find_and_replace(name, "-", "\\-") + " 1 \"\" \"raymap " +
                     version().text + "\"\n.SH NAME\n" + roff(name) + " \\- " +
                     roff(command.get_description()) + "\n.SH SYNOPSIS\n.B " +
                     (isProgram ? "raymap COMMAND" : "raymap " + command.get_name());
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) text += " " + option->get_type_name();
  text += isProgram ? "\n.SH COMMANDS\n" : " [OPTIONS]\n.SH OPTIONS\n";
  if (isProgram)
    for (const CLI::App* each : commandsIn(app))
      text += ".TP\n.B " + each->get_name() + "\n" + roff(each->get_description()) + "\n";
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional())
      text += ".TP\n.I " + option->get_type_name() + "\n" + roff(option->get_description()) + "\n";
  for (const OptionRow* row : optionsOf(command))
    text +=
        ".TP\n.B " + roff(allSpellings(*row) + " " + row->value) + "\n" + roff(helpIn(command, *row)) + "\n";
  return text + ".SH NOTES\n" + roffOfFooter(command.get_footer());
}

/// Returns the options over the commands, as docs/cli.md has them.
std::string tableOf(const CLI::App& app) {
  std::string text = "| option | also written | value | default | commands |\n|---|---|---|---|---|\n";
  for (const OptionRow& row : optionRows()) {
    std::string also, commands;
    const std::vector<std::string> shown = CLI::detail::split_up(listed(row));
    for (std::string other : CLI::detail::split(row.others, ',')) {
      if (other.starts_with('!')) other.erase(0, 1);
      if (!other.empty() && std::ranges::count(shown, other) == 0)
        also += (also.empty() ? "`" : ", `") + other + "`";
    }
    const std::string name = CLI::detail::split(row.name, ',').back();
    size_t count = 0;
    for (const CLI::App* command : commandsIn(app)) {
      if (command->get_option_no_throw(name) == nullptr) continue;
      commands += (commands.empty() ? "" : ", ") + command->get_name();
      ++count;
    }
    if (count == commandsIn(app).size()) commands = "all";
    text += "| `" + CLI::detail::find_and_replace(shownNames(row), ", ", "`, `") + "`";
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

void runManual(const CLI::App& app, const ManualArguments& arguments) {
  if (arguments.isTable) {
    write(arguments, tableOf(app));
    return;
  }
  const CLI::App* page = arguments.what.empty() ? &app : nullptr;
  for (const CLI::App* command : commandsIn(app))
    if (command->get_name() == arguments.what) page = command;
  if (page == nullptr)
    throw Error(ErrorCode::Usage, "there is no command " + arguments.what + "; see raymap --help");
  if (!std::filesystem::is_directory(arguments.output)) return write(arguments, manPage(app, *page));
  std::vector<const CLI::App*> pages{page};
  if (page == &app)
    for (const CLI::App* command : commandsIn(app)) pages.push_back(command);
  silenceText();
  for (const CLI::App* each : pages)
    write({.output = arguments.output / (nameOfPage(app, *each) + ".1")}, manPage(app, *each));
}

}  // namespace

void addCompletion(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("completion", "Print a shell completion script for commands and options");
  const auto arguments = std::make_shared<ManualArguments>();
  command->add_option("shell", arguments->what, "Shell: bash, zsh or fish")
      ->type_name("SHELL")
      ->transform(oneOf({"bash", "zsh", "fish"}))
      ->required();
  addOutput(*command, arguments->output, "Script to write; without it, it is printed");
  command->footer(
      "Examples:\n  source <(raymap completion bash)\n  raymap completion zsh -o ~/.zfunc/_raymap\n"
      "  raymap completion fish -o ~/.config/fish/completions/raymap.fish");
  command->callback([&app, arguments] {
    const auto make = arguments->what == "bash"  ? completionForBash
                      : arguments->what == "zsh" ? completionForZsh
                                                 : completionForFish;
    write(*arguments, make(app));
  });
}

void addManual(CLI::App& app) {
  CLI::App* command = app.add_subcommand("manual", "Print the man page of the program, or of a command");
  const auto arguments = std::make_shared<ManualArguments>();
  command->add_option("command", arguments->what, "Command to describe")->type_name("COMMAND");
  addOutput(*command, arguments->output,
            "Page to write; without it, it is printed. In a folder it is raymap.1 or raymap-COMMAND.1, and "
            "without COMMAND all pages are written there");
  addOption(*command, "--table", arguments->isTable);
  command->footer("Examples:\n  raymap manual repair | man -l -\n  raymap manual -o man/man1");
  command->callback([&app, arguments] { runManual(app, *arguments); });
}

}  // namespace raymap
