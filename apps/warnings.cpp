#include "warnings.h"

#include <array>
#include <cstdio>

#include "terminal.h"

namespace raymap {

namespace {

/// Returns a flag with its value; nothing if that is 0.
std::string lengthFlag(const char* name, double length) {
  std::array<char, 40> text{};
  if (length > 0.0) std::snprintf(text.data(), text.size(), "%s %g", name, length);
  return text.data();
}

}  // namespace

std::string remedyOf(const Warning& warning) {
  switch (warning.code) {
    case WarningCode::Rounding:
      return "--recenter";
    case WarningCode::DeviceRefused:
      return "raymap devices --test " + warning.fields.device;
    case WarningCode::DeviceFailed:
      return "--device cpu leaves the GPU out";
    case WarningCode::PartsInsideOut:
      return "--orientation keep";
    case WarningCode::OrientationMisfit:
      return "raymap info MESH";
    case WarningCode::PartsThickened:
    case WarningCode::SolidLost:
      return lengthFlag("--voxel-size", warning.fields.voxelSize);
    case WarningCode::NothingInside:
      return lengthFlag("--voxel-size", warning.fields.voxelSize) +
             lengthFlag("--thickness", warning.fields.length);
    case WarningCode::SurfaceLost:
      return "--min-thickness T";
    case WarningCode::PartsDropped:
      return "--drop-smaller 0";
    case WarningCode::PartsKept:
      return "--drop-smaller VOLUME";
    case WarningCode::PartsBuried:
    case WarningCode::CavitiesFilled:
      return "--keep-cavities";
    case WarningCode::HollowsFilled:
      return "--drain-hole W";
    case WarningCode::NoHollow:
      return "--shell T";
    case WarningCode::LooseBodies:
      return "leave out --keep-cavities";
    case WarningCode::BoundsLeft:
      return "--min-thickness T; raymap info MESH lists the holes";
    case WarningCode::Sheet:
      return "raymap info MESH";
    case WarningCode::FileContent:
    case WarningCode::BoxReached:
    case WarningCode::DrainHolesMissing:
    case WarningCode::TrianglesMissed:
    case WarningCode::FarVertices:
    case WarningCode::AttributesLost:
    case WarningCode::PartFile:
      break;
  }
  return {};
}

void warn(const Warning& warning) {
  const std::string remedy = remedyOf(warning);
  printWarning(warning.message + (remedy.empty() ? "" : " (" + remedy + ")"));
}

}  // namespace raymap
