#pragma once

#include <raymap/device_info.h>
#include <raymap/error.h>
#include <raymap/field.h>
#include <raymap/local_thickness.h>
#include <raymap/options.h>
#include <raymap/region.h>
#include <raymap/verdict.h>
#include <raymap/warning.h>

#include <span>
#include <string_view>

namespace raymap {

// Names of enum values, as the command line, JSON and raymap/c.h write them: "exact", "harmonic", "auto",
// "discrete", "device_lost", … All are in lower case.

RAYMAP_API std::string_view name(DistanceMode value);
RAYMAP_API std::string_view name(SignMode value);
RAYMAP_API std::string_view name(Sampling value);
RAYMAP_API std::string_view name(Orientation value);
RAYMAP_API std::string_view name(FieldArray value);
RAYMAP_API std::string_view name(FieldForm value);
RAYMAP_API std::string_view name(DeviceType value);
RAYMAP_API std::string_view name(DeviceTestState value);
RAYMAP_API std::string_view name(ErrorCode value);
RAYMAP_API std::string_view name(MeshKind value);
RAYMAP_API std::string_view name(Arrangement value);
RAYMAP_API std::string_view name(Remedy value);
RAYMAP_API std::string_view name(RepairDepth value);
RAYMAP_API std::string_view name(FieldReason value);
RAYMAP_API std::string_view name(Part value);
RAYMAP_API std::string_view name(WarningCode value);

/// Returns the value with a name. Throws `Error(Usage)` that lists the accepted names. `Enum` is one of the
/// types above.
template <class Enum>
Enum fromName(std::string_view text);

/// Returns all names of a type, in the order of its values.
template <class Enum>
std::span<const std::string_view> names();

#define RAYMAP_DECLARE_NAMES(Enum)                       \
  template <>                                            \
  RAYMAP_API Enum fromName<Enum>(std::string_view text); \
  template <>                                            \
  RAYMAP_API std::span<const std::string_view> names<Enum>();
RAYMAP_DECLARE_NAMES(DistanceMode)
RAYMAP_DECLARE_NAMES(SignMode)
RAYMAP_DECLARE_NAMES(Sampling)
RAYMAP_DECLARE_NAMES(Orientation)
RAYMAP_DECLARE_NAMES(FieldArray)
RAYMAP_DECLARE_NAMES(FieldForm)
RAYMAP_DECLARE_NAMES(DeviceType)
RAYMAP_DECLARE_NAMES(DeviceTestState)
RAYMAP_DECLARE_NAMES(ErrorCode)
RAYMAP_DECLARE_NAMES(MeshKind)
RAYMAP_DECLARE_NAMES(Arrangement)
RAYMAP_DECLARE_NAMES(Remedy)
RAYMAP_DECLARE_NAMES(RepairDepth)
RAYMAP_DECLARE_NAMES(FieldReason)
RAYMAP_DECLARE_NAMES(Part)
RAYMAP_DECLARE_NAMES(WarningCode)
#undef RAYMAP_DECLARE_NAMES

}  // namespace raymap
