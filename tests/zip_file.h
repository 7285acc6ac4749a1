#pragma once

// A ZIP archive of stored members, as 3MF files are.

#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "mesh_samples.h"

namespace raymap::samples {

inline std::string zipFile(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string bytes, directory;
  for (const auto& [name, content] : members) {
    const auto crc = static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
    const auto size = static_cast<uint32_t>(content.size());
    // Version needed, flags, method, time, date; checksum and sizes; lengths of the name and of extras.
    const std::string common = raw<uint16_t>({20, 0, 0, 0, 0x21}) + raw<uint32_t>({crc, size, size}) +
                               raw<uint16_t>({static_cast<uint16_t>(name.size()), 0});
    directory += raw(uint32_t{0x02014b50}) + raw<uint16_t>(20) + common + raw<uint16_t>({0, 0, 0}) +
                 raw<uint32_t>({0, static_cast<uint32_t>(bytes.size())}) + name;
    bytes += raw(uint32_t{0x04034b50}) + common + name + content;
  }
  const auto count = static_cast<uint16_t>(members.size());
  return bytes + directory + raw(uint32_t{0x06054b50}) + raw<uint16_t>({0, 0, count, count}) +
         raw<uint32_t>({static_cast<uint32_t>(directory.size()), static_cast<uint32_t>(bytes.size())}) +
         raw<uint16_t>(0);
}

}  // namespace raymap::samples
