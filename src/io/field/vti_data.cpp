#include "io/field/vti_data.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace raymap {

namespace {

int base64Value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

bool isBlank(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

struct Base64Reader {
  std::filesystem::path path;
  std::string_view text;
  uint32_t bits = 0;
  int bitCount = 0;

  unsigned char next() {
    while (bitCount < 8) {
      if (text.empty()) throwInvalid(path, "its base64 data ends early");
      const char c = text.front();
      text.remove_prefix(1);
      if (isBlank(c)) continue;
      if (c == '=') {
        bitCount = 0;  // End of a piece: the remaining bits of its last character are padding.
        continue;
      }
      const int value = base64Value(c);
      if (value < 0) throwInvalid(path, "its base64 data has a character that is not base64");
      bits = (bits << 6) | static_cast<uint32_t>(value);
      bitCount += 6;
    }
    bitCount -= 8;
    return static_cast<unsigned char>(bits >> bitCount);
  }
};

struct DecimalReader {
  std::filesystem::path path;
  std::string_view text;

  template <class Parsed, class T>
  void read(char* to, size_t count) {
    for (size_t at = 0; at < count; at += sizeof(T)) {
      while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
      Parsed parsed{};
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
      if (error != std::errc())
        throwInvalid(path, "its data ends early, or holds something that is not a number");
      text.remove_prefix(static_cast<size_t>(end - text.data()));
      const T value = static_cast<T>(parsed);
      std::memcpy(to + at, &value, sizeof(T));
    }
  }
};

struct BlockInflater {
  std::filesystem::path path;
  ReadBytes readPacked;
  std::vector<uint64_t> packedSizes;
  uint64_t blockBytes = 0, lastBytes = 0;
  size_t next = 0;
  std::vector<Bytef> packed, block;
  size_t used = 0;

  void inflateNext() {
    if (next == packedSizes.size()) throwInvalid(path, "its compressed data ends early");
    packed.resize(packedSizes[next++]);
    block.resize(next == packedSizes.size() ? lastBytes : blockBytes);
    readPacked(packed.data(), packed.size());
    auto made = static_cast<uLongf>(block.size());
    const int status = uncompress(block.data(), &made, packed.data(), static_cast<uLong>(packed.size()));
    if (status != Z_OK || made != block.size()) throwInvalid(path, "its compressed data is damaged");
    used = 0;
  }

  void read(char* to, size_t count) {
    while (count > 0) {
      if (used == block.size()) inflateNext();
      const size_t part = std::min(count, block.size() - used);
      std::memcpy(to, block.data() + used, part);
      used += part;
      to += part;
      count -= part;
    }
  }
};

}  // namespace

ReadBytes blocksInflated(const std::filesystem::path& path, const ReadBytes& read, const ReadCount& count,
                         uint64_t bytes, uint64_t available) {
  const uint64_t blocks = count(), blockBytes = count(), part = count(), last = part > 0 ? part : blockBytes;
  const uint64_t others = blocks - 1;
  const bool fits =
      blocks > 0 && blocks <= available && blockBytes > 0 && last > 0 && last <= bytes &&
      (others == 0 ? last == bytes : (bytes - last) / others == blockBytes && (bytes - last) % others == 0);
  if (!fits)
    throwInvalid(path, "its compressed blocks do not hold the " + std::to_string(bytes) +
                           " bytes of samples that its extent needs");
  std::vector<uint64_t> packedSizes(blocks);
  for (uint64_t& size : packedSizes)
    if ((size = count()) == 0 || size > available)
      throwInvalid(path, "a block of its compressed data is empty, or ends early");
  return [inflater = BlockInflater{path, read, std::move(packedSizes), blockBytes, last}](
             void* to, size_t wanted) mutable { inflater.read(static_cast<char*>(to), wanted); };
}

ReadBytes base64Decoded(const std::filesystem::path& path, std::string_view text) {
  return [reader = Base64Reader{path, text}](void* to, size_t count) mutable {
    auto* bytes = static_cast<unsigned char*>(to);
    for (size_t i = 0; i < count; ++i) bytes[i] = reader.next();
  };
}

ReadBytes decimalDecoded(const std::filesystem::path& path, std::string_view text, bool isWhole) {
  return [reader = DecimalReader{path, text}, isWhole](void* to, size_t count) mutable {
    if (isWhole)
      reader.read<int64_t, uint32_t>(static_cast<char*>(to), count);
    else
      reader.read<double, double>(static_cast<char*>(to), count);
  };
}

}  // namespace raymap
