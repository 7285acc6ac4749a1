#include <raymap/named_options.h>

#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"

namespace raymap::python {

namespace {

[[noreturn]] void refuseType(const char* name, const char* wanted, nb::handle value) {
  constexpr size_t kMostLetters = 40;
  std::string text = nb::repr(value).c_str();
  if (text.size() > kMostLetters) text = "a " + std::string(nb::type_name(value.type()).c_str());
  throw nb::type_error((std::string(name) + " must be " + wanted + ", not " + text).c_str());
}

/// Returns a whole number of Python. Throws as `operator.index` does.
OptionValue toWhole(const char* name, nb::handle value) {
  PyErr_Clear();
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  if (!index.is_valid()) {
    PyErr_Clear();
    refuseType(name, "a whole number", value);
  }
  uint64_t natural = 0;
  if (nb::try_cast(index, natural)) return natural;
  int64_t whole = 0;
  if (nb::try_cast(index, whole)) return whole;
  return PyFloat_AsDouble(index.ptr());  // Out of every range.
}

double toNumber(const char* name, nb::handle value) {
  const bool isText = nb::isinstance<nb::str>(value) || nb::isinstance<nb::bytes>(value);
  const double number = isText ? -1.0 : PyFloat_AsDouble(value.ptr());
  if (isText || PyErr_Occurred()) {
    PyErr_Clear();
    refuseType(name, "a number", value);
  }
  return number;
}

/// Appends the numbers of nested sequences.
void append(const char* name, nb::handle value, std::vector<double>& numbers) {
  if (!nb::isinstance<nb::sequence>(value)) return numbers.push_back(toNumber(name, value));
  for (const nb::handle each : nb::borrow<nb::sequence>(value)) append(name, each, numbers);
}

OptionValue toValue(const char* name, nb::handle value) {
  switch (optionKind(name)) {
    case OptionKind::Flag:
      return nb::cast<bool>(nb::bool_(nb::borrow(value)));
    case OptionKind::Whole:
      return toWhole(name, value);
    case OptionKind::Number:
      return toNumber(name, value);
    case OptionKind::Numbers: {
      std::vector<double> numbers;
      append(name, value, numbers);
      return numbers;
    }
    default:
      if (!nb::isinstance<nb::str>(value)) refuseType(name, "a text", value);
      return nb::cast<std::string>(value);
  }
}

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
          [](AllOptions& self, const std::string& name, nb::handle value) {
            setOption(self, name, toValue(name.c_str(), value));
          },
          "name"_a, "value"_a.none());
  module.def("options_that_take_none", &takeNone);
}

}  // namespace raymap::python
