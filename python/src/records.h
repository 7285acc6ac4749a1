#pragma once

#include <raymap/records.h>

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"

namespace raymap::python {

/// Returns a new object of a class of raymap._views.
template <class Object>
Object makeView(const char* name) {
  return nb::cast<Object>(nb::module_::import_("raymap._views").attr(name)());
}

/// Returns a result of the library (raymap/records.h) as a dict, or a member of one. Face indices become an
/// array.
template <class Value>
auto toPython(const Value& value) {
  if constexpr (Record<Value>) {
    auto dict = makeView<nb::dict>("Record");
    forEachMember(value, [&](const char* name, const auto& member) { dict[name] = toPython(member); });
    return dict;
  } else if constexpr (std::is_enum_v<Value>) {
    return nb::cast(name(value));
  } else if constexpr (std::is_same_v<Value, glm::dvec3> || std::is_same_v<Value, glm::ivec3>) {
    return nb::cast(std::vector{value.x, value.y, value.z});
  } else if constexpr (std::is_same_v<Value, Box>) {
    return toPython(corners(value));
  } else if constexpr (std::is_same_v<Value, std::vector<uint32_t>>) {
    return nb::cast(toArray<uint32_t>(value, {value.size()}));
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return toText(value);
  } else if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::optional<double>>) {
    return nb::cast(value);
  } else {
    constexpr bool kHoldsRecords = Record<std::remove_cvref_t<decltype(*value.begin())>>;
    auto list = kHoldsRecords ? makeView<nb::list>("Records") : nb::list();
    for (const auto& element : value) list.append(toPython(element));
    return list;
  }
}

}  // namespace raymap::python
