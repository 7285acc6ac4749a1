#pragma once

#include <string>
#include <vector>

#include "parser.h"

namespace raymap {

/// Returns what is wrong with a command line, and what to write instead; empty if nothing is.
std::string describeMistake(const Program& program, const Parsed& parsed);

/// A line of the text below the options, without its leading blanks.
struct FooterLine {
  size_t indent;
  std::string text;
};

/// Returns the lines of the text below the options. Each paragraph is one line, however the source wraps it.
std::vector<FooterLine> footerLines(const std::string& footer);

/// Returns the help of the program, or of a command. It wraps at the width of the terminal.
std::string helpOf(const Program& program);
std::string helpOf(const Command& command);

}  // namespace raymap
