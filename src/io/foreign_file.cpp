#include "io/foreign_file.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace raymap {

namespace {

struct ForeignKind {
  std::string_view bytes;    ///< First bytes; letters in lower case.
  std::string_view what;     ///< Kind of the file, and advice.
  std::string_view formats;  ///< Formats of meshes that begin so.
};

constexpr std::string_view kWebPage = "it is a web page; download the file itself";

constexpr std::array kKinds{
    ForeignKind{"pk\x03\x04", "it is a zip archive; unpack it", ".3mf"},
    ForeignKind{"\x1f\x8b", "it is compressed with gzip; unpack it", ""},
    ForeignKind{"bzh", "it is compressed with bzip2; unpack it", ""},
    ForeignKind{std::string_view("\xfd"
                                 "7zxz\0",
                                 6),
                "it is compressed with xz; unpack it", ""},
    ForeignKind{"\x28\xb5\x2f\xfd", "it is compressed with zstd; unpack it", ""},
    ForeignKind{"7z\xbc\xaf\x27\x1c", "it is a 7z archive; unpack it", ""},
    ForeignKind{"rar!\x1a\x07", "it is a RAR archive; unpack it", ""},
    ForeignKind{"\x89png\r\n", "it is a PNG picture", ""},
    ForeignKind{"\xff\xd8\xff", "it is a JPEG picture", ""},
    ForeignKind{"gif8", "it is a GIF picture", ""},
    ForeignKind{"%pdf-", "it is a PDF document", ""},
    ForeignKind{"\x7f"
                "elf",
                "it is a program", ""},
    ForeignKind{"\x89hdf\r\n", "it is an HDF5 file", ""},
    ForeignKind{"iso-10303-21", "it is a STEP file; export a mesh from it", ""},
    ForeignKind{"version https://git-lfs", "it is a pointer of Git LFS; fetch the file itself", ""},
    ForeignKind{"<!doctype html", kWebPage, ""},
    ForeignKind{"<html", kWebPage, ""},
    ForeignKind{"<", "it is XML", ".dae"},
    ForeignKind{"{", "it is JSON", ".gltf .glb"}};

}  // namespace

std::string foreignKind(std::string_view head, std::string_view format) {
  constexpr std::string_view kMark = "\xef\xbb\xbf", kBlanks = " \t\r\n";
  constexpr size_t kLongest = 64;
  std::string begin(head.substr(0, kLongest));
  for (char& c : begin) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::string_view words = begin;
  if (words.starts_with(kMark)) words.remove_prefix(kMark.size());
  words.remove_prefix(std::min(words.find_first_not_of(kBlanks), words.size()));
  for (const ForeignKind& kind : kKinds)
    if (std::string_view(begin).starts_with(kind.bytes) || words.starts_with(kind.bytes))
      return kind.formats.find(format) == std::string_view::npos ? std::string(kind.what) : "";
  return {};
}

}  // namespace raymap
