#include "vulkan/device/pipeline_cache_file.h"

#include <cstdio>
#include <cstring>
#include <optional>
#include <ostream>
#include <string>

#include "base/hash.h"
#include "base/user_cache.h"

namespace raymap::vulkan {

namespace {

constexpr size_t kVulkanHeader = 32;  // VkPipelineCacheHeaderVersionOne
constexpr uint64_t kMostBytes = uint64_t{1} << 28;

/// Begins the file. Its bytes are as in memory, because the file never leaves the machine.
struct Header {
  std::array<char, 8> magic{'R', 'A', 'Y', 'M', 'A', 'P', 'P', '1'};
  DriverIdentity identity;
  uint32_t unused = 0;
  uint64_t size = 0;
  uint64_t hash = 0;

  bool operator==(const Header&) const = default;
};
static_assert(sizeof(Header) == 8 + 28 + 4 + 16, "no padding, which would be written");

uint64_t hashOf(std::span<const std::byte> bytes) {
  return raymap::hashOf({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

std::filesystem::path PipelineCacheFile::name() const {
  char name[64];
  std::snprintf(name, sizeof name, "vulkan-pipelines-%04x-%04x.bin", identity_.vendor, identity_.device);
  return name;
}

std::vector<std::byte> PipelineCacheFile::read() const {
  const std::optional<std::string> content = readUserCache(name(), sizeof(Header) + kMostBytes);
  if (!content || content->size() < sizeof(Header)) return {};
  Header found;
  std::memcpy(&found, content->data(), sizeof found);
  const std::span<const std::byte> all = std::as_bytes(std::span(*content)),
                                   compiled = all.subspan(sizeof found);
  const Header expected{.identity = identity_, .size = compiled.size(), .hash = hashOf(compiled)};
  return found == expected ? std::vector<std::byte>(compiled.begin(), compiled.end())
                           : std::vector<std::byte>();
}

void PipelineCacheFile::write(std::span<const std::byte> compiled) const {
  if (compiled.size() <= kVulkanHeader || compiled.size() > kMostBytes) return;
  const Header header{.identity = identity_, .size = compiled.size(), .hash = hashOf(compiled)};
  writeUserCache(name(), [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(compiled.data()), static_cast<std::streamsize>(compiled.size()));
  });
}

}  // namespace raymap::vulkan
