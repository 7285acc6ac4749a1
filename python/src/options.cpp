#include <nanobind/stl/map.h>
#include <nanobind/stl/variant.h>
#include <raymap/named_options.h>

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

#include "bindings.h"

namespace raymap::python {

namespace {

/// Returns whether a default is none: no value, no text, a length of 0 or no limit.
template <class Member>
bool isNone(const Member& member) {
  if constexpr (std::is_same_v<Member, bool> || std::is_enum_v<Member>)
    return false;
  else if constexpr (std::is_arithmetic_v<Member>)
    return member == Member(0) || member == std::numeric_limits<Member>::infinity();
  else if constexpr (requires { member.has_value(); })
    return !member;
  else if constexpr (requires { member.empty(); })
    return member.empty();
  else
    return false;
}

/// Returns the kinds of all options, as numbers of `OptionKind`.
std::map<std::string, int> kinds() {
  std::map<std::string, int> found;
  for (const OptionText& option : optionTexts())
    found[std::string(option.name)] = int(optionKind(option.name));
  return found;
}

/// Returns the options of which None is a value.
std::set<std::string> takeNone() {
  std::set<std::string> names;
  const AllOptions all;
  forEachOption(all, [&](const OptionName& option, const auto& member) {
    if (isNone(member)) names.insert(option.name);
  });
  return names;
}

}  // namespace

void bindOptions(nb::module_& module) {
  nb::class_<AllOptions>(module, "Options")
      .def(nb::init<>())
      .def(
          "set",
          [](AllOptions& self, std::string_view name, const OptionValue& value) {
            setOption(self, name, value);
          },
          "name"_a, "value"_a);
  module.def("option_kinds", &kinds);
  module.def("options_that_take_none", &takeNone);
}

}  // namespace raymap::python
