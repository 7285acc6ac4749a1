#include "io/3mf/zip_parts.h"

#include <minizip/unzip.h>
#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace raymap {

/// The bytes of the file and minizip's position in them.
struct ZipParts::Source {
  std::span<const std::byte> bytes;
  size_t at = 0;
  bool isShort = false;  ///< Whether the last read went beyond the end.
};

namespace {

/// Returns the key of a part's name: in lower case and without the slash that absolute names begin with.
std::string keyOf(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string key(name);
  for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return key;
}

template <class Source>
uLong readBytes(voidpf opaque, voidpf, void* to, uLong count) {
  Source& source = *static_cast<Source*>(opaque);
  const size_t got = std::min<size_t>(count, source.bytes.size() - source.at);
  std::memcpy(to, source.bytes.data() + source.at, got);
  source.at += got;
  source.isShort = got < count;
  return static_cast<uLong>(got);
}

template <class Source>
ZPOS64_T tellBytes(voidpf opaque, voidpf) {
  return static_cast<Source*>(opaque)->at;
}

template <class Source>
long seekBytes(voidpf opaque, voidpf, ZPOS64_T offset, int origin) {
  Source& source = *static_cast<Source*>(opaque);
  const size_t from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                      : origin == ZLIB_FILEFUNC_SEEK_CUR ? source.at
                                                         : source.bytes.size();
  if (offset > source.bytes.size() - from) return -1;
  source.at = from + offset;
  return 0;
}

template <class Source>
zlib_filefunc64_def memoryFunctions(Source& source) {
  zlib_filefunc64_def functions{};
  functions.opaque = &source;
  functions.zopen64_file = [](voidpf opaque, const void*, int) { return opaque; };
  functions.zread_file = readBytes<Source>;
  functions.zwrite_file = [](voidpf, voidpf, const void*, uLong) { return uLong{0}; };
  functions.ztell64_file = tellBytes<Source>;
  functions.zseek64_file = seekBytes<Source>;
  functions.zclose_file = [](voidpf, voidpf) { return 0; };
  // minizip takes bytes beyond the end for zeros unless it is told of an error.
  functions.zerror_file = [](voidpf opaque, voidpf) { return static_cast<Source*>(opaque)->isShort ? 1 : 0; };
  return functions;
}

}  // namespace

ZipParts::ZipParts(const MeshFile& file)
    : file_(file), source_(new Source{file.bytes}), zip_(nullptr, &unzClose) {
  zlib_filefunc64_def functions = memoryFunctions(*source_);
  zip_.reset(unzOpen2_64("", &functions));
  if (!zip_) file.fail("it is no whole zip file, as a 3MF must be");
  int status = unzGoToFirstFile(zip_.get());
  for (; status == UNZ_OK; status = unzGoToNextFile(zip_.get())) {
    std::array<char, 1024> name{};
    unz_file_info64 info{};
    unz64_file_pos at{};
    if (unzGetCurrentFileInfo64(zip_.get(), &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) !=
            UNZ_OK ||
        unzGetFilePos64(zip_.get(), &at) != UNZ_OK)
      file.fail("its zip directory is damaged");
    const Place place{at.pos_in_zip_directory, at.num_of_file, (info.flag & 1) != 0};
    if (!places_.emplace(keyOf(name.data()), place).second)
      file.fail("it has the part '" + std::string(name.data()) + "' twice");
  }
  if (status != UNZ_END_OF_LIST_OF_FILE) file.fail("its zip directory is damaged");
}

ZipParts::~ZipParts() = default;

bool ZipParts::has(std::string_view name) const {
  return places_.contains(keyOf(name));
}

void ZipParts::read(std::string_view name, const std::function<void(std::string_view piece)>& take) {
  const std::string shown(name);
  const auto found = places_.find(keyOf(name));
  if (found == places_.end()) file_.fail("it has no part '" + shown + "'");
  if (found->second.isEncrypted)
    throw Error(ErrorCode::Unsupported, file_.path.string() + ": its part '" + shown + "' is encrypted");
  const unz64_file_pos at{found->second.position, found->second.number};
  if (unzGoToFilePos64(zip_.get(), &at) != UNZ_OK || unzOpenCurrentFile(zip_.get()) != UNZ_OK)
    file_.fail("its part '" + shown + "' is damaged, or compressed by another method than deflate");

  // Meshes deflate to a tenth, and at best to a fiftieth.
  constexpr uint64_t kMostRatio = 200, kSlack = 1 << 20;
  const uint64_t most = kSlack + kMostRatio * file_.bytes.size();
  std::vector<char> piece(size_t{1} << 16);
  for (;;) {
    const int got = unzReadCurrentFile(zip_.get(), piece.data(), static_cast<unsigned>(piece.size()));
    if (got < 0) file_.fail("its part '" + shown + "' is damaged or ends early");
    if (got == 0) break;
    inflated_ += static_cast<uint64_t>(got);
    if (inflated_ > most)
      file_.fail("its part '" + shown + "' inflates to more than " + std::to_string(kMostRatio) +
                 " times the size of the file, as no model does");
    take({piece.data(), static_cast<size_t>(got)});
  }
  if (unzCloseCurrentFile(zip_.get()) != UNZ_OK)
    file_.fail("the checksum of its part '" + shown + "' is wrong");
}

}  // namespace raymap
