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

/// Returns all names of an enum's values.
template <class Enum>
std::vector<std::string> namesOf() {
  const std::span<const std::string_view> accepted = names<Enum>();
  return {accepted.begin(), accepted.end()};
}

/// Returns what an argument sets: a member of a struct of options.
template <class Member>
Target targetOf(Member& member) {
  if constexpr (std::is_enum_v<Member>)
    return std::function([&member](const std::string& text) { member = fromName<Member>(text); });
  else
    return &member;
}

/// Adds the options of a struct of the library, but those that take several numbers, and those that a command
/// reads in a way of its own or has not.
template <class Options>
void addLibraryOptions(Command& command, Options& options,
                       std::initializer_list<std::string_view> except = {}) {
  forEachOption(options, [&](const OptionName& option, auto& member) {
    using Member = std::remove_reference_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member> || std::is_constructible_v<Target, Member*>)
      if (std::ranges::count(except, std::string_view(option.name)) == 0)
        addOptions(command, {{flagOf(option.name).c_str(), targetOf(member)}});
  });
}

}  // namespace raymap
