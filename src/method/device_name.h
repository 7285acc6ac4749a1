#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace raymap {

/// Parsed value of `MachineOptions::device`: "auto", "cpu", "vulkan" or "vulkan:K".
struct DeviceName {
  enum class Kind { Auto, Cpu, Vulkan };
  Kind kind = Kind::Auto;
  std::optional<size_t> index;  ///< K of "vulkan:K".
};

/// Parses a device name. Returns nullopt for any other text.
std::optional<DeviceName> parseDeviceName(std::string_view text);

}  // namespace raymap
