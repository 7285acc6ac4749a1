#include "method/device_name.h"

#include <charconv>

namespace raymap {

std::optional<DeviceName> parseDeviceName(std::string_view text) {
  if (text == "auto") return DeviceName{};
  if (text == "cpu") return DeviceName{.kind = DeviceName::Kind::Cpu};
  if (text == "vulkan") return DeviceName{.kind = DeviceName::Kind::Vulkan};
  constexpr std::string_view kPrefix = "vulkan:";
  if (!text.starts_with(kPrefix)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return DeviceName{.kind = DeviceName::Kind::Vulkan, .index = index};
}

}  // namespace raymap
