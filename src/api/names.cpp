#include <raymap/names.h>

#include <algorithm>
#include <array>
#include <string>

namespace raymap {

namespace {

/// The values of a type and their names, in the same order.
template <class Enum>
struct Names;

template <>
struct Names<DistanceMode> {
  static constexpr std::string_view kKind = "distance mode";
  static constexpr std::array kValues{DistanceMode::Exact, DistanceMode::Neighbours, DistanceMode::Cell,
                                      DistanceMode::Raster};
  static constexpr std::array<std::string_view, 4> kNames{"exact", "neighbours", "cell", "raster"};
};

template <>
struct Names<SignMode> {
  static constexpr std::string_view kKind = "sign mode";
  static constexpr std::array kValues{SignMode::Harmonic,  SignMode::Exact, SignMode::Paths,
                                      SignMode::Evolution, SignMode::Rays,  SignMode::Ray,
                                      SignMode::None};
  static constexpr std::array<std::string_view, 7> kNames{"harmonic", "exact", "paths", "evolution",
                                                          "rays",     "ray",   "none"};
};

template <>
struct Names<Sampling> {
  static constexpr std::string_view kKind = "sampling";
  static constexpr std::array kValues{Sampling::Spread, Sampling::Paper};
  static constexpr std::array<std::string_view, 2> kNames{"spread", "paper"};
};

template <>
struct Names<Orientation> {
  static constexpr std::string_view kKind = "orientation";
  static constexpr std::array kValues{Orientation::Auto, Orientation::Keep, Orientation::Repair};
  static constexpr std::array<std::string_view, 3> kNames{"auto", "keep", "repair"};
};

template <>
struct Names<FieldArray> {
  static constexpr std::string_view kKind = "array";
  static constexpr std::array kValues{FieldArray::Distance, FieldArray::Winding, FieldArray::Confidence,
                                      FieldArray::Triangle};
  static constexpr std::array<std::string_view, 4> kNames{"distance", "winding", "confidence", "triangle"};
};

template <>
struct Names<FieldForm> {
  static constexpr std::string_view kKind = "form of a field";
  static constexpr std::array kValues{FieldForm::Whole, FieldForm::NarrowBand, FieldForm::Slabs};
  static constexpr std::array<std::string_view, 3> kNames{"whole", "narrow_band", "slabs"};
};

template <>
struct Names<DeviceType> {
  static constexpr std::string_view kKind = "type of device";
  static constexpr std::array kValues{DeviceType::Discrete, DeviceType::Integrated, DeviceType::Virtual,
                                      DeviceType::Other,    DeviceType::Software,   DeviceType::Cpu};
  static constexpr std::array<std::string_view, 6> kNames{"discrete", "integrated", "virtual",
                                                          "other",    "software",   "cpu"};
};

template <>
struct Names<DeviceTestState> {
  static constexpr std::string_view kKind = "state of a device's test";
  static constexpr std::array kValues{DeviceTestState::Untested, DeviceTestState::Running,
                                      DeviceTestState::Passed, DeviceTestState::Failed,
                                      DeviceTestState::Unfinished};
  static constexpr std::array<std::string_view, 5> kNames{"untested", "running", "passed", "failed",
                                                          "unfinished"};
};

template <>
struct Names<Part> {
  static constexpr std::string_view kKind = "part";
  static constexpr std::array kValues{Part::Wall,  Part::Edge,  Part::Corner,
                                      Part::Solid, Part::Sheet, Part::Buried};
  static constexpr std::array<std::string_view, 6> kNames{"wall",  "edge",  "corner",
                                                          "solid", "sheet", "buried"};
};

template <>
struct Names<ErrorCode> {
  static constexpr std::string_view kKind = "error code";
  static constexpr std::array kValues{ErrorCode::Usage,      ErrorCode::Input,       ErrorCode::File,
                                      ErrorCode::Memory,     ErrorCode::Cancelled,   ErrorCode::Unsupported,
                                      ErrorCode::DeviceLost, ErrorCode::DeviceMemory};
  static constexpr std::array<std::string_view, 8> kNames{
      "usage", "input", "file", "memory", "cancelled", "unsupported", "device_lost", "device_memory"};
};

template <>
struct Names<MeshKind> {
  static constexpr std::string_view kKind = "kind of mesh";
  static constexpr std::array kValues{MeshKind::NoSurface,
                                      MeshKind::DoubleSided,
                                      MeshKind::Soup,
                                      MeshKind::Sheet,
                                      MeshKind::OpenSolid,
                                      MeshKind::TurnedFaces,
                                      MeshKind::OverlappingSolids,
                                      MeshKind::TouchingSolids,
                                      MeshKind::MisnestedSolids,
                                      MeshKind::CrossingSolid,
                                      MeshKind::FlawedSolid,
                                      MeshKind::InsideOut,
                                      MeshKind::SeveralSolids,
                                      MeshKind::CleanSolid};
  static constexpr std::array<std::string_view, 14> kNames{"no_surface",
                                                           "double_sided",
                                                           "soup",
                                                           "sheet",
                                                           "open_solid",
                                                           "turned_faces",
                                                           "overlapping_solids",
                                                           "touching_solids",
                                                           "misnested_solids",
                                                           "crossing_solid",
                                                           "flawed_solid",
                                                           "inside_out",
                                                           "several_solids",
                                                           "clean_solid"};
};

template <>
struct Names<Arrangement> {
  static constexpr std::string_view kKind = "arrangement";
  static constexpr std::array kValues{Arrangement::Unknown,  Arrangement::Separate,
                                      Arrangement::Nested,   Arrangement::Misnested,
                                      Arrangement::Touching, Arrangement::Overlapping};
  static constexpr std::array<std::string_view, 6> kNames{"unknown",   "separate", "nested",
                                                          "misnested", "touching", "overlapping"};
};

template <>
struct Names<Remedy> {
  static constexpr std::string_view kKind = "remedy";
  static constexpr std::array kValues{Remedy::None, Remedy::Repair, Remedy::Thicken};
  static constexpr std::array<std::string_view, 3> kNames{"none", "repair", "thicken"};
};

template <>
struct Names<RepairDepth> {
  static constexpr std::string_view kKind = "depth of a repair";
  static constexpr std::array kValues{RepairDepth::AsGiven, RepairDepth::Mended, RepairDepth::Field};
  static constexpr std::array<std::string_view, 3> kNames{"as_given", "mended", "field"};
};

template <>
struct Names<FieldReason> {
  static constexpr std::string_view kKind = "reason of a field";
  static constexpr std::array kValues{FieldReason::None, FieldReason::Asked, FieldReason::Open,
                                      FieldReason::Sheet, FieldReason::Crossing};
  static constexpr std::array<std::string_view, 5> kNames{"none", "asked", "open", "sheet", "crossing"};
};

template <>
struct Names<WarningCode> {
  static constexpr std::string_view kKind = "warning code";
  static constexpr std::array kValues{WarningCode::FileContent,
                                      WarningCode::Rounding,
                                      WarningCode::DeviceRefused,
                                      WarningCode::DeviceFailed,
                                      WarningCode::OrientationMisfit,
                                      WarningCode::PartsInsideOut,
                                      WarningCode::BoxReached,
                                      WarningCode::SolidLost,
                                      WarningCode::SurfaceLost,
                                      WarningCode::PartsDropped,
                                      WarningCode::PartsKept,
                                      WarningCode::PartsBuried,
                                      WarningCode::CavitiesFilled,
                                      WarningCode::HollowsFilled,
                                      WarningCode::NoHollow,
                                      WarningCode::DrainHolesMissing,
                                      WarningCode::TrianglesMissed,
                                      WarningCode::NothingInside,
                                      WarningCode::Sheet,
                                      WarningCode::BoundsLeft,
                                      WarningCode::PartsThickened,
                                      WarningCode::LooseBodies,
                                      WarningCode::FarVertices,
                                      WarningCode::AttributesLost,
                                      WarningCode::PartFile};
  static constexpr std::array<std::string_view, 25> kNames{
      "file_content",        "rounding",         "device_refused",  "device_failed",   "orientation_misfit",
      "parts_inside_out",    "box_reached",      "solid_lost",      "surface_lost",    "parts_dropped",
      "parts_kept",          "parts_buried",     "cavities_filled", "hollows_filled",  "no_hollow",
      "drain_holes_missing", "triangles_missed", "nothing_inside",  "sheet",           "bounds_left",
      "parts_thickened",     "loose_bodies",     "far_vertices",    "attributes_lost", "part_file"};
};

template <class Enum>
std::string_view nameOf(Enum value) {
  using N = Names<Enum>;
  const auto at = std::ranges::find(N::kValues, value);
  if (at == N::kValues.end())
    throw Error(ErrorCode::Usage, "there is no " + std::string(N::kKind) + " with the value " +
                                      std::to_string(static_cast<int>(value)));
  return N::kNames[static_cast<size_t>(at - N::kValues.begin())];
}

template <class Enum>
Enum valueOf(std::string_view text) {
  using N = Names<Enum>;
  const auto at = std::ranges::find(N::kNames, text);
  if (at != N::kNames.end()) return N::kValues[static_cast<size_t>(at - N::kNames.begin())];
  std::string known;
  for (const std::string_view each : N::kNames)
    known.append(known.empty() ? "" : each == N::kNames.back() ? " or " : ", ").append(each);
  throw Error(ErrorCode::Usage,
              "there is no " + std::string(N::kKind) + " '" + std::string(text) + "'; use " + known);
}

}  // namespace

#define RAYMAP_DEFINE_NAMES(Enum)                   \
  std::string_view name(Enum value) {               \
    return nameOf(value);                           \
  }                                                 \
  template <>                                       \
  Enum fromName<Enum>(std::string_view text) {      \
    return valueOf<Enum>(text);                     \
  }                                                 \
  template <>                                       \
  std::span<const std::string_view> names<Enum>() { \
    return Names<Enum>::kNames;                     \
  }
RAYMAP_DEFINE_NAMES(DistanceMode)
RAYMAP_DEFINE_NAMES(SignMode)
RAYMAP_DEFINE_NAMES(Sampling)
RAYMAP_DEFINE_NAMES(Orientation)
RAYMAP_DEFINE_NAMES(FieldArray)
RAYMAP_DEFINE_NAMES(FieldForm)
RAYMAP_DEFINE_NAMES(DeviceType)
RAYMAP_DEFINE_NAMES(DeviceTestState)
RAYMAP_DEFINE_NAMES(ErrorCode)
RAYMAP_DEFINE_NAMES(MeshKind)
RAYMAP_DEFINE_NAMES(Arrangement)
RAYMAP_DEFINE_NAMES(Remedy)
RAYMAP_DEFINE_NAMES(RepairDepth)
RAYMAP_DEFINE_NAMES(FieldReason)
RAYMAP_DEFINE_NAMES(Part)
RAYMAP_DEFINE_NAMES(WarningCode)

}  // namespace raymap
