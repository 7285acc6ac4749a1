#pragma once

// A ZIP archive, as .3mf and .npz files are.

#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "mesh_samples.h"

namespace raymap::samples {

/// The members of a `DeflatedLying` archive claim the largest size that its directory can hold. A
/// `StoredIn64Bits` one has all sizes and places in the fields of 64 bits, as lib3mf writes them.
enum class Zip { Stored, StoredIn64Bits, Deflated, DeflatedLying };

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
  const bool isStored = kind == Zip::Stored || kind == Zip::StoredIn64Bits;
  const bool is64 = kind == Zip::StoredIn64Bits;
  constexpr uint32_t kIn64Bits = 0xffffffffU;
  std::string bytes, directory;
  for (const auto& [name, content] : members) {
    const auto crc = static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
    const std::string packed = isStored ? content : deflated(content);
    const auto packedSize = is64 ? kIn64Bits : static_cast<uint32_t>(packed.size());
    const auto size = is64                         ? kIn64Bits
                      : kind == Zip::DeflatedLying ? 0xfffffffeU
                                                   : static_cast<uint32_t>(content.size());
    const uint16_t method = isStored ? 0 : 8;
    const std::string sizes = raw<uint64_t>({content.size(), packed.size()});
    const std::string local = is64 ? raw<uint16_t>({1, 16}) + sizes : "";
    const std::string central = is64 ? raw<uint16_t>({1, 24}) + sizes + raw<uint64_t>(bytes.size()) : "";
    // Version needed, flags, method, time, date; checksum and sizes; lengths of the name and of extras.
    const auto common = [&, nameBytes = static_cast<uint16_t>(name.size())](const std::string& extra) {
      return raw<uint16_t>({20, 0, method, 0, 0x21}) + raw<uint32_t>({crc, packedSize, size}) +
             raw<uint16_t>({nameBytes, static_cast<uint16_t>(extra.size())});
    };
    directory += raw(uint32_t{0x02014b50}) + raw<uint16_t>(20) + common(central) + raw<uint16_t>({0, 0, 0}) +
                 raw<uint32_t>({0, is64 ? kIn64Bits : static_cast<uint32_t>(bytes.size())}) + name + central;
    bytes += raw(uint32_t{0x04034b50}) + common(local) + name + local + packed;
  }
  const uint64_t begin = bytes.size(), end = begin + directory.size();
  bytes += directory;
  if (is64)
    bytes += raw(uint32_t{0x06064b50}) + raw(uint64_t{44}) + raw<uint16_t>({45, 45}) + raw<uint32_t>({0, 0}) +
             raw<uint64_t>({members.size(), members.size(), directory.size(), begin}) +
             raw(uint32_t{0x07064b50}) + raw(uint32_t{0}) + raw(end) + raw(uint32_t{1});
  const auto count = is64 ? uint16_t{0xffff} : static_cast<uint16_t>(members.size());
  return bytes + raw(uint32_t{0x06054b50}) + raw<uint16_t>({0, 0, count, count}) +
         raw<uint32_t>({is64 ? kIn64Bits : static_cast<uint32_t>(directory.size()),
                        is64 ? kIn64Bits : static_cast<uint32_t>(begin)}) +
         raw<uint16_t>(0);
}

}  // namespace raymap::samples
