#include "io/field/zip_writer.h"

#include <minizip/zip.h>
#include <raymap/error.h>

#include <exception>
#include <ostream>
#include <utility>

namespace raymap {

/// Lets minizip write to a stream. Exceptions must not cross its C code, so `problem` keeps the first one.
struct ZipStream {
  std::ostream& out;
  std::exception_ptr problem;

  template <class Work>
  auto guarded(Work&& work, decltype(work()) otherwise) noexcept {
    try {
      return work();
    } catch (...) {
      if (!problem) problem = std::current_exception();
      return otherwise;
    }
  }
};

namespace {

ZipStream& streamOf(voidpf opaque) {
  return *static_cast<ZipStream*>(opaque);
}

uLong writeStream(voidpf opaque, voidpf, const void* data, uLong count) {
  ZipStream& zip = streamOf(opaque);
  return zip.guarded(
      [&] {
        zip.out.write(static_cast<const char*>(data), static_cast<std::streamsize>(count));
        return count;
      },
      uLong{0});
}
ZPOS64_T tellStream(voidpf opaque, voidpf) {
  ZipStream& zip = streamOf(opaque);
  return zip.guarded([&] { return static_cast<ZPOS64_T>(zip.out.tellp()); }, ZPOS64_T(-1));
}
long seekStream(voidpf opaque, voidpf, ZPOS64_T offset, int origin) {
  ZipStream& zip = streamOf(opaque);
  const auto from = origin == ZLIB_FILEFUNC_SEEK_SET   ? std::ios_base::beg
                    : origin == ZLIB_FILEFUNC_SEEK_CUR ? std::ios_base::cur
                                                       : std::ios_base::end;
  return zip.guarded(
      [&] {
        zip.out.seekp(static_cast<std::streamoff>(offset), from);
        return 0L;
      },
      -1L);
}

zlib_filefunc64_def streamFunctions(ZipStream& zip) {
  zlib_filefunc64_def functions{};
  functions.opaque = &zip;
  functions.zopen64_file = [](voidpf opaque, const void*, int) { return opaque; };
  functions.zread_file = [](voidpf, voidpf, void*, uLong) { return uLong{0}; };
  functions.zwrite_file = writeStream;
  functions.ztell64_file = tellStream;
  functions.zseek64_file = seekStream;
  functions.zclose_file = [](voidpf, voidpf) { return 0; };
  functions.zerror_file = [](voidpf, voidpf) { return 0; };
  return functions;
}

}  // namespace

ZipWriter::ZipWriter(std::ostream& out) : stream_(new ZipStream{out, nullptr}) {
  zlib_filefunc64_def functions = streamFunctions(*stream_);
  zip_ = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
  check(zip_ != nullptr);
}

ZipWriter::~ZipWriter() {
  if (zip_) zipClose(zip_, nullptr);
}

void ZipWriter::begin(const std::string& name, int level, Size size) {
  zip_fileinfo info{};
  info.dosDate = (1U << 21) | (1U << 16);  // 1 January 1980.
  check(zipOpenNewFileInZip64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                              level > 0 ? Z_DEFLATED : 0, level, size == Size::Any ? 1 : 0) == ZIP_OK);
}

void ZipWriter::beginDeflated(const std::string& name, Size size) {
  constexpr int kLevel = 6;  // zlib's own default.
  begin(name, kLevel, size);
}

void ZipWriter::write(std::string_view bytes) {
  constexpr size_t kPiece = size_t{1} << 24;  // minizip counts in 32 bits.
  for (size_t begin = 0; begin < bytes.size(); begin += kPiece) {
    const std::string_view piece = bytes.substr(begin, kPiece);
    check(zipWriteInFileInZip(zip_, piece.data(), static_cast<unsigned>(piece.size())) == ZIP_OK);
  }
}

void ZipWriter::endFile() {
  check(zipCloseFileInZip(zip_) == ZIP_OK);
}

void ZipWriter::add(const std::string& name, const std::string& header, std::span<const std::byte> bytes) {
  begin(name, 0, Size::Any);
  write(header);
  write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  endFile();
}

void ZipWriter::finish() {
  check(zipClose(std::exchange(zip_, nullptr), nullptr) == ZIP_OK);
}

void ZipWriter::check(bool good) const {
  if (stream_->problem) std::rethrow_exception(stream_->problem);
  if (!good)
    throw Error(ErrorCode::File, "cannot write a zip file (.npz, .3mf) here: it needs a regular file");
}

}  // namespace raymap
