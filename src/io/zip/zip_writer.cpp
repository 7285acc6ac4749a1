// Writes zips by libzip; docs/dev/decisions/zip.md says why.

#include "io/zip/zip_writer.h"

#include <raymap/error.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <new>
#include <ostream>
#include <string_view>
#include <utility>

namespace raymap {

namespace {

/// A source or target of libzip, as an object. Exceptions must not cross libzip's C code, so `problem`
/// keeps the first one.
class Source {
 public:
  explicit Source(std::exception_ptr& problem) : problem_(problem) {}
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  /// Gives the object to libzip. Returns null if memory is short.
  static zip_source_t* create(std::unique_ptr<Source> source) {
    Source* const object = source.release();
    zip_source_t* const made = zip_source_function_create(&call, object, nullptr);
    if (!made) delete object;
    return made;
  }

 protected:
  virtual zip_int64_t answer(zip_source_cmd_t command, void* data, zip_uint64_t bytes) = 0;

  static zip_int64_t giveSize(void* data, uint64_t size) {
    auto& about = *static_cast<zip_stat_t*>(data);
    zip_stat_init(&about);
    about.size = size;
    about.valid = ZIP_STAT_SIZE;
    return sizeof about;
  }

 private:
  static zip_int64_t call(void* self, void* data, zip_uint64_t bytes, zip_source_cmd_t command) noexcept {
    auto& source = *static_cast<Source*>(self);
    if (command == ZIP_SOURCE_FREE) {
      delete &source;
      return 0;
    }
    if (command == ZIP_SOURCE_ERROR) {
      zip_error_t error;
      zip_error_init_with_code(&error, ZIP_ER_WRITE);
      return zip_error_to_data(&error, data, bytes);
    }
    try {
      return source.answer(command, data, bytes);
    } catch (...) {
      if (!source.problem_) source.problem_ = std::current_exception();
      return -1;
    }
  }

  std::exception_ptr& problem_;
};

/// The stream that the zip goes to. libzip goes back in it to write the sizes of deflated files.
class Target : public Source {
 public:
  Target(std::ostream& out, std::exception_ptr& problem) : Source(problem), out_(out) {}

 private:
  zip_int64_t answer(zip_source_cmd_t command, void* data, zip_uint64_t bytes) override {
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(
            ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR,
            ZIP_SOURCE_FREE, ZIP_SOURCE_SEEK, ZIP_SOURCE_TELL, ZIP_SOURCE_BEGIN_WRITE,
            ZIP_SOURCE_COMMIT_WRITE, ZIP_SOURCE_ROLLBACK_WRITE, ZIP_SOURCE_WRITE, ZIP_SOURCE_SEEK_WRITE,
            ZIP_SOURCE_TELL_WRITE, ZIP_SOURCE_REMOVE, -1);
      case ZIP_SOURCE_STAT:
        return giveSize(data, 0);
      case ZIP_SOURCE_WRITE:
        out_.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
        return out_.good() ? static_cast<zip_int64_t>(bytes) : -1;
      case ZIP_SOURCE_SEEK_WRITE: {
        const auto& to = *static_cast<const zip_source_args_seek_t*>(data);
        const auto from = to.whence == SEEK_SET   ? std::ios_base::beg
                          : to.whence == SEEK_CUR ? std::ios_base::cur
                                                  : std::ios_base::end;
        return out_.seekp(to.offset, from).good() ? 0 : -1;
      }
      case ZIP_SOURCE_TELL_WRITE:
        return out_.tellp();
      default:
        return 0;  // Nothing is read, and beginning and ending are the caller's.
    }
  }

  std::ostream& out_;
};

/// Content of a file. libzip reads it once, from the beginning.
class Content : public Source {
 protected:
  Content(uint64_t size, std::exception_ptr& problem) : Source(problem), size_(size) {}

  /// Returns the next bytes, and none at the end. They stay until the next call.
  virtual std::string_view next() = 0;

 private:
  zip_int64_t answer(zip_source_cmd_t command, void* data, zip_uint64_t bytes) override {
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
      case ZIP_SOURCE_STAT:
        return giveSize(data, size_);
      case ZIP_SOURCE_READ:
        return read(static_cast<char*>(data), bytes);
      default:
        return 0;
    }
  }

  zip_int64_t read(char* to, zip_uint64_t most) {
    if (rest_.empty()) rest_ = next();
    const size_t count = std::min<size_t>(rest_.size(), most);
    std::copy_n(rest_.begin(), count, to);
    rest_.remove_prefix(count);
    return static_cast<zip_int64_t>(count);
  }

  uint64_t size_;
  std::string_view rest_;
};

class HeaderAndBytes : public Content {
 public:
  HeaderAndBytes(std::string header, std::string_view bytes, std::exception_ptr& problem)
      : Content(header.size() + bytes.size(), problem), header_(std::move(header)), parts_{header_, bytes} {}

 private:
  std::string_view next() override {
    while (at_ < parts_.size())
      if (const std::string_view part = parts_[at_++]; !part.empty()) return part;
    return {};
  }

  std::string header_;
  std::array<std::string_view, 2> parts_;
  size_t at_ = 0;
};

using Piece = std::function<std::string(size_t)>;

uint64_t sizeOf(size_t count, const Piece& piece) {
  uint64_t size = 0;
  for (size_t i = 0; i < count; ++i) size += piece(i).size();
  return size;
}

class Pieces : public Content {
 public:
  Pieces(size_t count, Piece piece, std::exception_ptr& problem)
      : Content(sizeOf(count, piece), problem), count_(count), piece_(std::move(piece)) {}

 private:
  std::string_view next() override {
    while (at_ < count_)
      if (text_ = piece_(at_++); !text_.empty()) return text_;
    return {};
  }

  size_t count_;
  Piece piece_;
  size_t at_ = 0;
  std::string text_;
};

}  // namespace

ZipWriter::ZipWriter(std::ostream& out) {
  zip_source_t* const target = Source::create(std::make_unique<Target>(out, problem_));
  zip_ = target ? zip_open_from_source(target, ZIP_CREATE | ZIP_TRUNCATE, nullptr) : nullptr;
  if (!zip_) zip_source_free(target);
  check(zip_ != nullptr);
}

ZipWriter::~ZipWriter() {
  if (zip_) zip_discard(zip_);
}

void ZipWriter::add(const std::string& name, std::string header, std::span<const std::byte> bytes) {
  const std::string_view view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  addSource(name, Source::create(std::make_unique<HeaderAndBytes>(std::move(header), view, problem_)),
            ZIP_CM_STORE);
}

void ZipWriter::addDeflated(const std::string& name, size_t count, std::function<std::string(size_t)> piece) {
  addSource(name, Source::create(std::make_unique<Pieces>(count, std::move(piece), problem_)),
            ZIP_CM_DEFLATE);
}

void ZipWriter::addSource(const std::string& name, zip_source* source, int method) {
  constexpr int kLevel = 6;                                  // zlib's own default. libzip's is 9.
  constexpr zip_uint16_t kTime = 0, kDate = (1U << 5) | 1U;  // 1 January 1980.
  const zip_int64_t index = source ? zip_file_add(zip_, name.c_str(), source, ZIP_FL_ENC_UTF_8) : -1;
  if (index < 0) zip_source_free(source);
  check(index >= 0);
  const auto at = static_cast<zip_uint64_t>(index);
  check(zip_set_file_compression(zip_, at, method, method == ZIP_CM_DEFLATE ? kLevel : 0) == 0);
  check(zip_file_set_dostime(zip_, at, kTime, kDate, 0) == 0);
}

void ZipWriter::finish() {
  const bool good = zip_close(zip_) == 0;
  if (good) zip_ = nullptr;
  check(good);
}

void ZipWriter::check(bool good) const {
  if (problem_) std::rethrow_exception(problem_);
  if (!good)
    throw Error(ErrorCode::File, "cannot write a zip file (.npz, .3mf) here: it needs a regular file");
}

}  // namespace raymap
