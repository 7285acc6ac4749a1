#pragma once

#include <raymap/warning.h>

#include <string>

namespace raymap {

/// Returns the option or command that helps against what a warning tells of, in the words of the command
/// line; empty if there is none.
std::string remedyOf(const Warning& warning);

/// Prints a warning of the library on stderr, with its remedy.
void warn(const Warning& warning);

}  // namespace raymap
