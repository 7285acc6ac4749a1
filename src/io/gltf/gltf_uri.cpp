#include "io/gltf/gltf_uri.h"

#include <array>

#include "base/text.h"

namespace raymap {

namespace {

constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<int8_t, 256> base64Values() {
  std::array<int8_t, 256> values{};
  values.fill(-1);
  for (size_t i = 0; i < kBase64.size(); ++i)
    values[static_cast<unsigned char>(kBase64[i])] = static_cast<int8_t>(i);
  return values;
}

Buffer<std::byte> decodeDataUri(const MeshFile& file, std::string_view uri) {
  static constexpr std::array<int8_t, 256> kValues = base64Values();
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.find(kMark);
  if (mark == uri.npos) file.fail("a data URI is not in base64");
  std::string_view text = uri.substr(mark + kMark.size());
  while (text.ends_with('=')) text.remove_suffix(1);

  Buffer<std::byte> bytes(text.size() * 3 / 4);
  uint32_t bits = 0;
  size_t written = 0;
  int held = 0;
  for (const char c : text) {
    const int8_t value = kValues[static_cast<unsigned char>(c)];
    if (value < 0) file.fail("a data URI holds a character that is not base64");
    bits = bits << 6 | static_cast<uint32_t>(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes[written++] = static_cast<std::byte>(bits >> held & 0xff);
  }
  return bytes;
}

}  // namespace

Buffer<std::byte> loadUri(const MeshFile& file, std::string_view uri) {
  if (uri.starts_with("data:")) return decodeDataUri(file, uri);
  const std::string name = unescapedUri(uri);
  if (uri.find(':') != uri.npos || name.empty() || name.find('\0') != name.npos)
    file.fail("it refers to " + excerpt(uri, kLongestName) + "; only files in its own folder are read");
  return loadFile(SourceFile(file.folder, name, file.path));
}

}  // namespace raymap
