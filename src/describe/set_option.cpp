#include <raymap/named_options.h>
#include <raymap/names.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "base/require.h"

namespace raymap {

namespace {

// ---- Messages ----

std::string shown(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", number);
  return text;
}

std::string shown(const OptionValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const int64_t* whole = std::get_if<int64_t>(&value)) return std::to_string(*whole);
  if (const uint64_t* whole = std::get_if<uint64_t>(&value)) return std::to_string(*whole);
  if (const double* number = std::get_if<double>(&value)) return shown(*number);
  if (const std::string* text = std::get_if<std::string>(&value)) return "'" + *text + "'";
  return std::to_string(std::get<std::vector<double>>(value).size()) + " numbers";
}

[[noreturn]] void refuse(const OptionName& option, const std::string& wanted, const OptionValue& value) {
  throw Error(ErrorCode::Usage, std::string(option.name) + " must be " + wanted + ", not " + shown(value));
}

/// Returns what a number must be: "above 0", "1 or more", "finite".
std::string wantedBy(const Range& range, double value) {
  if (std::isinf(value) && value > 0.0) return "finite";
  const bool isLimited = range.least > -std::numeric_limits<double>::max();
  if (!isLimited) return "finite";
  return range.isAbove ? "above " + shown(range.least) : shown(range.least) + " or more";
}

// ---- Values of one type ----

double numberOf(const OptionName& option, const OptionValue& value) {
  double number = 0.0;
  if (const int64_t* whole = std::get_if<int64_t>(&value))
    number = double(*whole);
  else if (const uint64_t* natural = std::get_if<uint64_t>(&value))
    number = double(*natural);
  else if (const double* given = std::get_if<double>(&value))
    number = *given;
  else
    refuse(option, "a number", value);
  const Range& range = option.range;
  const bool isInRange = (range.isAbove ? number > range.least : number >= range.least) &&
                         (range.mayBeInfinite || number <= std::numeric_limits<double>::max());
  if (!isInRange) refuse(option, wantedBy(range, number), value);
  return number;
}

template <class Whole>
Whole wholeOf(const OptionName& option, const OptionValue& value) {
  constexpr double kExact = 0x1p53;  // From here on, not every whole number is a double.
  const auto checked = [&](auto given) {
    if (double(given) < option.range.least) refuse(option, shown(option.range.least) + " or more", value);
    if (!std::in_range<Whole>(given))
      refuse(option, std::to_string(std::numeric_limits<Whole>::max()) + " or less", value);
    return Whole(given);
  };
  if (const int64_t* whole = std::get_if<int64_t>(&value)) return checked(*whole);
  if (const uint64_t* whole = std::get_if<uint64_t>(&value)) return checked(*whole);
  const double* number = std::get_if<double>(&value);
  if (number && std::abs(*number) <= kExact && *number == std::floor(*number))
    return checked(static_cast<int64_t>(*number));
  refuse(option, "a whole number", value);
}

/// Returns so many numbers; any multiple of it if `isList`.
const std::vector<double>& numbersOf(const OptionName& option, const OptionValue& value, size_t count,
                                     bool isList = false) {
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  const bool isRight = numbers && (isList ? numbers->size() % count == 0 : numbers->size() == count);
  if (!isRight)
    refuse(option, isList && count == 1 ? "numbers" : "numbers (" + std::string(option.unit) + ")", value);
  for (double number : *numbers)
    if (!std::isfinite(number)) refuse(option, "finite", OptionValue(number));
  return *numbers;
}

glm::dvec3 vectorAt(const std::vector<double>& numbers, size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

glm::ivec3 samplesAt(const OptionName& option, const std::vector<double>& numbers, size_t first) {
  glm::ivec3 samples;
  for (size_t a = 0; a < 3; ++a) samples[int(a)] = wholeOf<int>(option, numbers[first + a]);
  return samples;
}

// ---- Members ----

void assign(const OptionName& option, bool& member, const OptionValue& value) {
  const bool* flag = std::get_if<bool>(&value);
  const double number = flag ? double(*flag) : numberOf({option.name, "", kFromZero}, value);
  if (number != 0.0 && number != 1.0) refuse(option, "0 or 1", value);
  member = number == 1.0;
}

void assign(const OptionName& option, std::string& member, const OptionValue& value) {
  if (!std::holds_alternative<std::string>(value)) refuse(option, "a text", value);
  member = std::get<std::string>(value);
}

void assign(const OptionName& option, double& member, const OptionValue& value) {
  member = numberOf(option, value);
}

template <std::integral Whole>
void assign(const OptionName& option, Whole& member, const OptionValue& value) {
  member = wholeOf<Whole>(option, value);
}

template <class Enum>
requires std::is_enum_v<Enum>
void assign(const OptionName& option, Enum& member, const OptionValue& value) {
  std::string text;
  assign(option, text, value);
  member = fromName<Enum>(text);
}

void assign(const OptionName& option, glm::dvec3& member, const OptionValue& value) {
  member = vectorAt(numbersOf(option, value, 3), 0);
}

void assign(const OptionName& option, glm::ivec3& member, const OptionValue& value) {
  member = samplesAt(option, numbersOf(option, value, 3), 0);
}

void assign(const OptionName& option, Box& member, const OptionValue& value) {
  const std::vector<double>& numbers = numbersOf(option, value, 6);
  member = {vectorAt(numbers, 0), vectorAt(numbers, 3)};
}

void assign(const OptionName& option, Plane& member, const OptionValue& value) {
  const std::vector<double>& numbers = numbersOf(option, value, 4);
  member = {.normal = vectorAt(numbers, 0), .offset = numbers[3]};
}

void assign(const OptionName& option, std::vector<double>& member, const OptionValue& value) {
  const std::vector<double>& numbers = numbersOf(option, value, 1, true);
  for (double number : numbers) numberOf(option, number);
  member = numbers;
}

void assign(const OptionName& option, std::vector<glm::ivec3>& member, const OptionValue& value) {
  const std::vector<double>& numbers = numbersOf(option, value, 3, true);
  member.clear();
  for (size_t i = 0; i < numbers.size(); i += 3) member.push_back(samplesAt(option, numbers, i));
}

template <class Member>
void assign(const OptionName& option, std::optional<Member>& member, const OptionValue& value) {
  Member made{};
  assign(option, made, value);
  member = std::move(made);
}

// ---- Kinds ----

template <class Member>
constexpr OptionKind kKind = OptionKind::Numbers;
template <>
constexpr OptionKind kKind<bool> = OptionKind::Flag;
template <>
constexpr OptionKind kKind<double> = OptionKind::Number;
template <>
constexpr OptionKind kKind<std::string> = OptionKind::Text;
template <std::integral Whole>
constexpr OptionKind kKind<Whole> = OptionKind::Whole;
template <class Enum>
requires std::is_enum_v<Enum>
constexpr OptionKind kKind<Enum> = OptionKind::Choice;
template <class Member>
constexpr OptionKind kKind<std::optional<Member>> = kKind<Member>;

[[noreturn]] void refuseName(std::string_view name) {
  throw Error(ErrorCode::Usage, "there is no option '" + std::string(name) + "'");
}

}  // namespace

void setOption(AllOptions& options, std::string_view name, const OptionValue& value) {
  bool isFound = false;
  forEachOption(options, [&](const OptionName& option, auto& member) {
    if (name != option.name) return;
    assign(option, member, value);
    isFound = true;
  });
  if (!isFound) refuseName(name);
}

OptionKind optionKind(std::string_view name) {
  std::optional<OptionKind> kind;
  static const AllOptions kAll;
  forEachOption(kAll, [&](const OptionName& option, const auto& member) {
    if (name == option.name) kind = kKind<std::remove_cvref_t<decltype(member)>>;
  });
  if (!kind) refuseName(name);
  return *kind;
}

}  // namespace raymap
