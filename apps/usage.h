#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <vector>

namespace raymap {

/// Returns what is wrong with the arguments, and what to write instead. CLI11's own words name no remedy.
std::string describeUsageError(const CLI::App& app, const CLI::ParseError& error,
                               std::span<const std::string> arguments);

/// A line of the text below the options, without its leading blanks.
struct FooterLine {
  size_t indent;
  std::string text;
};

/// Returns the lines of the text below the options. Each paragraph is one line, however the source wraps it.
std::vector<FooterLine> footerLines(const std::string& footer);

/// Help that wraps at the width of the terminal, and shows each option as its row does.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool isPositional) const override;
  std::string make_option_usage(const CLI::Option* option) const override;
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

}  // namespace raymap
