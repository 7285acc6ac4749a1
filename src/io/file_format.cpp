#include "io/file_format.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <sstream>

#include "io/mesh/mesh_file.h"

namespace raymap {

namespace {

constexpr size_t kHeadBytes = size_t{1} << 16;
constexpr std::string_view kBlanks = " \t\r\n";

struct Signature {
  std::string_view bytes;
  std::string_view format;
};

constexpr std::array kSignatures{Signature{"ply\n", ".ply"},     Signature{"ply\r", ".ply"},
                                 Signature{"glTF", ".glb"},      Signature{"NRRD000", ".nrrd"},
                                 Signature{"\x93NUMPY", ".npy"}, Signature{" BDV", ".vdb"},
                                 Signature{"NanoVDB", ".nvdb"},  Signature{"Kaydara FBX Binary", ".fbx"},
                                 Signature{"; FBX", ".fbx"}};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Returns the first word of the first line that is neither empty nor a comment.
std::string_view firstWord(std::string_view text) {
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    if (!text.starts_with('#')) return text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
}

/// Returns the format of a zip file with this first entry.
std::string_view formatOfZip(std::string_view head) {
  constexpr size_t kLengthAt = 26, kNameAt = 30;
  if (head.size() < kNameAt) return {};
  const size_t length = static_cast<unsigned char>(head[kLengthAt]) +
                        256 * static_cast<size_t>(static_cast<unsigned char>(head[kLengthAt + 1]));
  const std::string_view name = head.substr(kNameAt, length);
  if (name.ends_with(".npy")) return ".npz";
  const bool isModel = name == "[Content_Types].xml" || name.starts_with("_rels/") || name.starts_with("3D/");
  return isModel ? ".3mf" : "";
}

bool isBinaryStl(std::string_view head, uint64_t bytes) {
  constexpr size_t kCountAt = 80, kFacetsAt = 84, kFacetBytes = 50;
  if (head.size() <= kFacetsAt) return false;
  uint32_t count = 0;
  std::memcpy(&count, head.data() + kCountAt, sizeof count);
  return bytes == kFacetsAt + uint64_t{count} * kFacetBytes;
}

std::string_view formatOfText(std::string_view head) {
  constexpr std::array<std::string_view, 10> kObjWords{"v", "vn", "vt", "f",      "o",
                                                       "g", "s",  "l",  "mtllib", "usemtl"};
  constexpr std::array<std::string_view, 6> kOffWords{"off", "coff", "noff", "cnoff", "stoff", "4off"};
  const std::string_view word = firstWord(head);
  if (std::ranges::find(kObjWords, word) != kObjWords.end()) return ".obj";
  if (std::ranges::find(kOffWords, lower(word)) != kOffWords.end()) return ".off";
  if (word.starts_with('{')) return ".gltf";
  if (word.starts_with('<'))
    return head.find("<VTKFile") != head.npos ? ".vti" : head.find("<COLLADA") != head.npos ? ".dae" : "";
  const std::string text = lower(head);
  const bool isStl =
      (lower(word) == "solid" && (text.find("facet") != text.npos || text.find("endsolid") != text.npos)) ||
      (lower(word) == "facet" && text.find("vertex") != text.npos);
  return isStl ? ".stl" : "";
}

std::string_view formatOfBytes(std::string_view head, uint64_t bytes) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";  // Of a text's byte order.
  if (head.starts_with(kMark)) head.remove_prefix(kMark.size());
  for (const Signature& signature : kSignatures)
    if (head.starts_with(signature.bytes)) return signature.format;
  if (head.starts_with("PK\x03\x04")) return formatOfZip(head);
  return isBinaryStl(head, bytes) ? ".stl" : formatOfText(head);
}

/// Returns the format of a table of points, or nothing for bytes that are not text.
std::string_view formatOfTable(std::string_view head) {
  const auto isControl = [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < ' ' && kBlanks.find(c) == kBlanks.npos;
  };
  if (head.empty() || std::ranges::any_of(head, isControl)) return {};
  return head.find_first_of(",;") != head.npos ? ".csv" : ".xyz";
}

}  // namespace

bool contains(const Formats& formats, std::string_view format) {
  return std::ranges::find(formats, format) != formats.end();
}

std::string formatOf(const SourceFile& source, std::string_view given, const Formats& known) {
  if (std::string named = lowerExtension(source.path()); contains(known, named)) return named;
  if (contains(known, given)) return std::string(given);
  std::error_code error;
  if (!std::filesystem::exists(source.place(), error))
    throw Error(ErrorCode::File, source.path().string() + ": no such file; check the path");
  if (std::filesystem::is_directory(source.place(), error))
    throw Error(ErrorCode::File, source.path().string() + ": it is a folder; give a file in it");
  std::string found = formatOfContent(source);
  if (found.empty() && contains(known, ".csv")) found = formatOfTable(source.head(kHeadBytes));
  return contains(known, found) ? found : "";
}

std::string formatOfContent(const SourceFile& source) {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(source.place(), error);
  return std::string(formatOfBytes(source.head(kHeadBytes), error ? 0 : bytes));
}

std::string formatOf(const std::filesystem::path& path, std::string_view given, const Formats& known) {
  std::string named = lowerExtension(path);
  return given.empty() || contains(known, named) ? named : std::string(given);
}

std::string listOf(const Formats& formats) {
  std::string text;
  for (const std::string& format : formats) text += (text.empty() ? "" : " ") + format;
  return text;
}

void writeSeekable(std::ostream& out, const std::function<void(std::ostream&)>& write) {
  if (out.tellp() != std::ostream::pos_type(-1)) return write(out);
  std::ostringstream memory;
  write(memory);
  const std::string_view bytes = memory.view();
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace raymap
