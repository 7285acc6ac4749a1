// The zip format, as far as packages use it: stored and deflated parts, and 64-bit sizes. lib3mf writes those
// for parts of any size, and minizip 1.1 does not read them on 64-bit machines.

#include "io/3mf/zip_parts.h"

#include <raymap/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace raymap {

namespace {

constexpr uint16_t kStored = 0, kDeflated = 8;
constexpr uint32_t kIn64Bits = 0xffffffff;  ///< Stands for a number that a field of 64 bits holds.

/// Returns the key of a part's name: in lower case and without the slash that absolute names begin with.
std::string keyOf(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string key(name);
  for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return key;
}

/// Bytes of a zip. Reading beyond their end fails.
struct Record {
  const MeshFile& file;
  std::string_view bytes;

  template <class T>
  T number(size_t at) const {
    T value;
    std::memcpy(&value, part(at, sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view part(uint64_t at, uint64_t count) const {
    if (at > bytes.size() || count > bytes.size() - at) file.fail("its zip directory is damaged");
    return bytes.substr(at, count);
  }
  Record from(uint64_t at) const { return {file, part(at, at <= bytes.size() ? bytes.size() - at : 0)}; }
};

/// The central directory: its bytes and the number of its entries.
struct Directory {
  Record record;
  uint64_t count = 0;
};

Directory findDirectory(const MeshFile& file) {
  constexpr size_t kEndBytes = 22, kLongestComment = 0xffff, kLocatorBytes = 20;
  const Record whole{file, file.text()};
  const size_t size = whole.bytes.size();
  size_t end = size < kEndBytes ? whole.bytes.npos : whole.bytes.rfind("PK\5\6", size - kEndBytes);
  if (end == whole.bytes.npos || size - end > kEndBytes + kLongestComment)
    file.fail("it is no whole zip file, as a 3MF must be");
  uint64_t count = whole.number<uint16_t>(end + 10);
  uint64_t bytes = whole.number<uint32_t>(end + 12), begin = whole.number<uint32_t>(end + 16);
  const bool is64 = end >= kLocatorBytes && whole.part(end - kLocatorBytes, 4) == "PK\6\7";
  if (is64) {
    const Record end64 = whole.from(whole.number<uint64_t>(end - kLocatorBytes + 8));
    if (end64.part(0, 4) != "PK\6\6") file.fail("its zip directory is damaged");
    count = end64.number<uint64_t>(32);
    bytes = end64.number<uint64_t>(40);
    begin = end64.number<uint64_t>(48);
  }
  return {{file, whole.part(begin, bytes)}, count};
}

/// Replaces numbers that did not fit 32 bits by those of the extra field that has 64.
void read64Bits(const Record& extra, const std::array<uint64_t*, 3>& numbers) {
  for (size_t at = 0; at + 4 <= extra.bytes.size(); at += 4 + extra.number<uint16_t>(at + 2)) {
    if (extra.number<uint16_t>(at) != 1) continue;
    const Record field{extra.file, extra.part(at + 4, extra.number<uint16_t>(at + 2))};
    size_t next = 0;
    for (uint64_t* number : numbers) {
      if (*number != kIn64Bits) continue;
      *number = field.number<uint64_t>(next);
      next += sizeof(uint64_t);
    }
  }
}

/// zlib's decompressor of a part.
class Inflater {
 public:
  explicit Inflater(std::string_view packed) : packed_(packed) {
    if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK) throw std::bad_alloc();  // Without a header of zlib's.
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills the buffer as far as the part goes. Returns false if the part is damaged.
  bool read(std::vector<char>& buffer, size_t& count) {
    stream_.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream_.avail_out = static_cast<uInt>(buffer.size());
    while (stream_.avail_out > 0 && !isOver_) {
      if (stream_.avail_in == 0) refill();
      const int status = inflate(&stream_, Z_NO_FLUSH);
      isOver_ = status == Z_STREAM_END;
      if (status != Z_OK && !isOver_) return false;
    }
    count = buffer.size() - stream_.avail_out;
    return true;
  }

 private:
  void refill() {
    constexpr size_t kMost = size_t{1} << 30;  // zlib counts in 32 bits.
    const std::string_view piece = packed_.substr(0, kMost);
    packed_.remove_prefix(piece.size());
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));
    stream_.avail_in = static_cast<uInt>(piece.size());
  }

  std::string_view packed_;
  z_stream stream_{};
  bool isOver_ = false;
};

}  // namespace

ZipParts::ZipParts(const MeshFile& file) : file_(file) {
  const Directory directory = findDirectory(file);
  uint64_t at = 0;
  for (uint64_t i = 0; i < directory.count; ++i) {
    constexpr size_t kHeaderBytes = 46;
    const Record header = directory.record.from(at);
    if (header.part(0, 4) != "PK\1\2") file.fail("its zip directory is damaged");
    const auto nameBytes = header.number<uint16_t>(28), extraBytes = header.number<uint16_t>(30);
    Entry entry{(header.number<uint16_t>(8) & 1) != 0, header.number<uint16_t>(10),
                header.number<uint32_t>(16), header.number<uint32_t>(20), header.number<uint32_t>(42)};
    uint64_t bytes = header.number<uint32_t>(24);
    const std::string name(header.part(kHeaderBytes, nameBytes));
    read64Bits({file, header.part(kHeaderBytes + nameBytes, extraBytes)},
               {&bytes, &entry.packedBytes, &entry.header});
    if (!entries_.emplace(keyOf(name), entry).second) file.fail("it has the part '" + name + "' twice");
    at += kHeaderBytes + nameBytes + extraBytes + header.number<uint16_t>(32);
  }
}

bool ZipParts::has(std::string_view name) const {
  return entries_.contains(keyOf(name));
}

std::string_view ZipParts::contentOf(const Entry& entry, const std::string& name) const {
  constexpr uint64_t kHeaderBytes = 30;
  const Record header = Record{file_, file_.text()}.from(entry.header);
  if (header.part(0, 4) != "PK\3\4") file_.fail("its part '" + name + "' is damaged or ends early");
  const uint64_t content = kHeaderBytes + header.number<uint16_t>(26) + header.number<uint16_t>(28);
  return header.part(content, entry.packedBytes);
}

void ZipParts::read(std::string_view name, const std::function<void(std::string_view piece)>& take) {
  const std::string shown(name);
  const auto found = entries_.find(keyOf(name));
  if (found == entries_.end()) file_.fail("it has no part '" + shown + "'");
  const Entry& entry = found->second;
  if (entry.isEncrypted)
    throw Error(ErrorCode::Unsupported, file_.path.string() + ": its part '" + shown + "' is encrypted");
  if (entry.method != kStored && entry.method != kDeflated)
    throw Error(ErrorCode::Unsupported, file_.path.string() + ": its part '" + shown +
                                            "' is compressed by another method than deflate");

  // Meshes deflate to a tenth, and at best to a fiftieth.
  constexpr uint64_t kMostRatio = 200, kSlack = 1 << 20;
  const uint64_t most = kSlack + kMostRatio * file_.bytes.size();
  std::string_view stored = contentOf(entry, shown);
  Inflater inflater(stored);
  std::vector<char> buffer(size_t{1} << 16);
  uLong checksum = crc32(0, nullptr, 0);
  for (;;) {
    size_t count = std::min(stored.size(), buffer.size());
    if (entry.method == kStored)
      std::copy_n(stored.data(), count, buffer.data()), stored.remove_prefix(count);
    else if (!inflater.read(buffer, count))
      file_.fail("its part '" + shown + "' is damaged or ends early");
    if (count == 0) break;
    inflated_ += count;
    if (inflated_ > most)
      file_.fail("its part '" + shown + "' inflates to more than " + std::to_string(kMostRatio) +
                 " times the size of the file, as no model does");
    checksum = crc32(checksum, reinterpret_cast<const Bytef*>(buffer.data()), static_cast<uInt>(count));
    take({buffer.data(), count});
  }
  if (checksum != entry.checksum) file_.fail("the checksum of its part '" + shown + "' is wrong");
}

}  // namespace raymap
