#pragma once

// A ZIP archive, as .3mf and .npz files are.

#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "mesh_samples.h"

namespace raymap::samples {

/// The members of a `DeflatedLying` archive claim the largest size that its directory can hold.
enum class Zip { Stored, Deflated, DeflatedLying };

/// Returns the content deflated, without zlib's header and checksum.
inline std::string deflated(const std::string& content) {
  uLongf size = compressBound(static_cast<uLong>(content.size()));
  std::string bytes(size, '\0');
  compress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
           static_cast<uLong>(content.size()));
  return bytes.substr(2, size - 6);
}

inline std::string zipFile(const std::vector<std::pair<std::string, std::string>>& members,
                           Zip kind = Zip::Stored) {
  std::string bytes, directory;
  for (const auto& [name, content] : members) {
    const auto crc = static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
    const std::string packed = kind == Zip::Stored ? content : deflated(content);
    const auto packedSize = static_cast<uint32_t>(packed.size());
    const auto size = kind == Zip::DeflatedLying ? 0xfffffffeU : static_cast<uint32_t>(content.size());
    const uint16_t method = kind == Zip::Stored ? 0 : 8;
    // Version needed, flags, method, time, date; checksum and sizes; lengths of the name and of extras.
    const std::string common = raw<uint16_t>({20, 0, method, 0, 0x21}) +
                               raw<uint32_t>({crc, packedSize, size}) +
                               raw<uint16_t>({static_cast<uint16_t>(name.size()), 0});
    directory += raw(uint32_t{0x02014b50}) + raw<uint16_t>(20) + common + raw<uint16_t>({0, 0, 0}) +
                 raw<uint32_t>({0, static_cast<uint32_t>(bytes.size())}) + name;
    bytes += raw(uint32_t{0x04034b50}) + common + name + packed;
  }
  const auto count = static_cast<uint16_t>(members.size());
  return bytes + directory + raw(uint32_t{0x06054b50}) + raw<uint16_t>({0, 0, count, count}) +
         raw<uint32_t>({static_cast<uint32_t>(directory.size()), static_cast<uint32_t>(bytes.size())}) +
         raw<uint16_t>(0);
}

}  // namespace raymap::samples
