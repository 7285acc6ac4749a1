#pragma once

// Options of the library on the command line, as raymap/named_options.h describes them.

#include <raymap/named_options.h>
#include <raymap/names.h>

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "options.h"
#include "parser.h"

namespace raymap {

/// Returns rows in which what is left open is filled in: the value, the default and the help of an option of
/// the library. Adds rows of options that have none.
std::vector<OptionRow> completed(std::span<const OptionRow> rows);

/// Returns "--close-holes" for the option close_holes.
std::string flagOf(std::string_view option);

/// Returns what an argument sets: a member of a struct of options. Null for several numbers.
template <class Member>
Target targetOf(Member& member) {
  if constexpr (std::is_enum_v<Member>)
    return std::function([&member](const std::string& text) { member = fromName<Member>(text); });
  else if constexpr (std::is_constructible_v<Target, Member*>)
    return &member;
  else
    return std::function<void(const std::string&)>();
}

/// Adds the options of a struct of the library, but those that take several numbers, and those that a command
/// reads in a way of its own or has not.
template <class Options>
void addLibraryOptions(Command& command, Options& options,
                       std::initializer_list<std::string_view> except = {}) {
  forEachOption(options, [&](const OptionName& option, auto& member) {
    const Target target = targetOf(member);
    const auto* call = std::get_if<std::function<void(const std::string&)>>(&target);
    if ((call && !*call) || std::ranges::count(except, std::string_view(option.name)) > 0) return;
    addOptions(command, {{flagOf(option.name).c_str(), target}});
  });
}

}  // namespace raymap
