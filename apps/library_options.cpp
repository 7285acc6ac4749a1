#include "library_options.h"

#include <cctype>
#include <cstdio>
#include <deque>
#include <optional>
#include <set>

#include "text.h"

namespace raymap {

namespace {

using enum Takes;

/// Returns a text for as long as the program runs, as rows need it.
const char* kept(std::string text) {
  static std::deque<std::string> texts;
  return texts.emplace_back(std::move(text)).c_str();
}

/// Returns the text of an option; nothing if there is none of this name.
std::string_view libraryText(std::string_view name) {
  const auto found = std::ranges::find(optionTexts(), name, &OptionText::name);
  return found == optionTexts().end() ? std::string_view() : found->text;
}

/// Returns a text of the library as help has it: options with dashes, and what a flag does.
std::string helpText(std::string_view text) {
  constexpr std::string_view kWhether = "Whether to ";
  std::string help;
  const size_t start = text.starts_with(kWhether) ? kWhether.size() : 0;
  const std::vector<std::string> parts =
      split(replaced(std::string(text.substr(start)), "Unset:", "Without it:"), '`');
  for (size_t p = 0; p < parts.size(); ++p)
    help += p % 2 == 1 && !libraryText(parts[p]).empty() ? flagOf(parts[p]) : parts[p];
  help[0] = char(std::toupper(static_cast<unsigned char>(help[0])));
  if (help.ends_with('.')) help.pop_back();
  return help;
}

template <class Number>
Takes takesOf(const Number&, const Range& range) {
  if constexpr (std::is_floating_point_v<Number>)
    return range.isAbove ? AboveZero : range.least == 0.0 ? FromZero : Takes::Number;
  else
    return range.least == 1.0 ? Natural : sizeof(Number) > sizeof(int) ? Whole : Count;
}

/// Returns a default as help shows it; nothing for none, and for a 0 that the help explains.
template <class Number>
std::string shown(Number number, std::string_view help) {
  if ((number == Number(0) && help.find("0 = ") != help.npos) || double(number) > 1e300) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", double(number));
  return text;
}

/// Fills in what a value is, from the type of a member.
template <class Member>
void describeValue(OptionRow& row, const OptionName& option, const Member& member) {
  const auto fallback = [&](const std::string& text) {
    if (row.fallback == nullptr) row.fallback = kept(text);
  };
  const bool isOpen = row.takes == Library;
  if constexpr (std::is_same_v<Member, bool>) {
    row.takes = Nothing;
  } else if constexpr (std::is_enum_v<Member>) {
    row.takes = Choice;
    row.choices = namesOf<Member>;
    fallback(std::string(name(member)));
  } else if constexpr (std::is_arithmetic_v<Member>) {
    if (isOpen) row.takes = takesOf(member, option.range);
    fallback(shown(member, row.help));
  } else if constexpr (requires { member.has_value(); }) {
    fallback("");
    return describeValue(row, option, typename Member::value_type());
  } else if constexpr (std::is_same_v<Member, std::string>) {
    row.takes = Text;
    fallback(member);
  } else {
    const std::string unit = option.unit;
    row.takes = unit == "DIRECTION"     ? Direction
                : unit == "X Y Z"       ? Vector
                : unit == "NX NY NZ"    ? Triple
                : unit == "NX NY NZ D"  ? Takes::Plane
                : unit.ends_with("...") ? List
                                        : Corners;
  }
  fallback("");
}

}  // namespace

std::string flagOf(std::string_view option) {
  return "--" + replaced(std::string(option), "_", "-");
}

std::vector<OptionRow> completed(std::span<const OptionRow> given) {
  std::vector<OptionRow> rows(given.begin(), given.end());
  static const AllOptions kAll;
  std::set<std::string> named;
  for (const OptionRow& row : rows) named.insert(longName(row));
  const auto addOthers = [&](const auto& options, const char* group) {
    forEachOption(options, [&](const OptionName& option, const auto&) {
      if (const auto [name, isNew] = named.insert(flagOf(option.name)); isNew)
        rows.push_back({kept(*name), "", group});
    });
  };
  addOthers(kAll.grid, "Grid");
  addOthers(kAll.field, "Method");
  addOthers(kAll.repair, "Shape");
  for (OptionRow& row : rows) {
    if (row.help != nullptr) continue;
    const std::string name = replaced(longName(row).substr(2), "-", "_");
    forEachOption(kAll, [&](const OptionName& option, const auto& member) {
      if (row.help != nullptr || option.name != name) return;
      if (row.value == nullptr) row.value = option.unit;
      row.help = kept(helpText(libraryText(name)));
      describeValue(row, option, member);
    });
  }
  return rows;
}

}  // namespace raymap
