#include "vti_data.h"

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
        bitCount = 0;  // The end of a piece: what is left of its last character is padding.
        continue;
      }
      const int value = base64Value(c);
      if (value < 0) throwInvalid(path, "its base64 data has a character that is none of base64's");
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
        throwInvalid(path, "its data ends early, or holds something that is no number");
      text.remove_prefix(static_cast<size_t>(end - text.data()));
      const T value = static_cast<T>(parsed);
      std::memcpy(to + at, &value, sizeof(T));
    }
  }
};

}  // namespace

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
