// Reads zips by libzip; docs/dev/decisions/zip.md says why.

#include "io/zip/zip_reader.h"

#include <raymap/error.h>
#include <zip.h>

#include <algorithm>
#include <new>
#include <utility>

#include "base/text.h"

namespace raymap {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what,
                       ErrorCode code = ErrorCode::Input) {
  throw Error(code, path.string() + ": " + what);
}

std::string part(const std::string& name) {
  return "its part " + excerpt(name, kLongestName) + " ";
}

[[noreturn]] void failContent(const std::filesystem::path& path, const std::string& name, int code) {
  if (code == ZIP_ER_MEMORY) throw std::bad_alloc();
  if (code == ZIP_ER_CRC) fail(path, "the checksum of its part " + excerpt(name, kLongestName) + " is wrong");
  fail(path, part(name) + "is damaged or ends early");
}

[[noreturn]] void failDirectory(const std::filesystem::path& path) {
  fail(path, "it is not a whole zip file, as a .3mf or .npz must be: its directory is missing or damaged");
}

/// Opens the zip of a source, which may be null if `error` says why.
zip_t* opened(zip_source_t* source, zip_error_t& error, const std::filesystem::path& path) {
  zip_t* const zip = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
  if (zip) return zip;
  zip_source_free(source);
  if (zip_error_code_zip(&error) == ZIP_ER_MEMORY) throw std::bad_alloc();
  failDirectory(path);
}

zip_t* openedFile(const SourceFile& source) {
  zip_error_t error{};
  return opened(zip_source_file_create(source.place().c_str(), 0, 0, &error), error, source.path());
}

zip_t* openedBytes(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  zip_error_t error{};
  return opened(zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error), error, path);
}

}  // namespace

ZipContent::ZipContent(zip_file_t* file, const std::filesystem::path& path, std::string name)
    : file_(file, &zip_fclose), path_(path), name_(std::move(name)) {}

size_t ZipContent::read(void* to, size_t count) {
  constexpr size_t kPiece = size_t{1} << 18;  // The checksum is computed from the processor's cache.
  size_t total = 0;
  while (total < count) {
    const zip_int64_t got =
        zip_fread(file_.get(), static_cast<char*>(to) + total, std::min(count - total, kPiece));
    if (got < 0) failContent(path_, name_, zip_error_code_zip(zip_file_get_error(file_.get())));
    if (got == 0) break;
    total += static_cast<size_t>(got);
  }
  return total;
}

ZipReader::ZipReader(const SourceFile& source)
    : path_(source.path()), zip_(openedFile(source), &zip_discard) {
  readDirectory();
}

ZipReader::ZipReader(std::span<const std::byte> bytes, std::filesystem::path path)
    : path_(std::move(path)), zip_(openedBytes(bytes, path_), &zip_discard) {
  readDirectory();
}

void ZipReader::readDirectory() {
  const auto count = static_cast<zip_uint64_t>(zip_get_num_entries(zip_.get(), 0));
  if (count == 0) failDirectory(path_);  // libzip takes an empty file for an empty zip.
  entries_.reserve(count);
  for (zip_uint64_t i = 0; i < count; ++i) {
    zip_stat_t about;
    const char* const name = zip_get_name(zip_.get(), i, ZIP_FL_ENC_RAW);
    if (!name || zip_stat_index(zip_.get(), i, 0, &about) != 0) failDirectory(path_);
    entries_.push_back({name, about.size});
  }
}

ZipContent ZipReader::open(size_t entry) const {
  const std::string& name = entries_[entry].name;
  zip_stat_t about;
  if (zip_stat_index(zip_.get(), entry, 0, &about) != 0) failDirectory(path_);
  if (about.encryption_method != ZIP_EM_NONE)
    fail(path_, part(name) + "is encrypted", ErrorCode::Unsupported);
  if (about.comp_method != ZIP_CM_STORE && about.comp_method != ZIP_CM_DEFLATE)
    fail(path_, part(name) + "is compressed by another method than deflate", ErrorCode::Unsupported);
  zip_file_t* const file = zip_fopen_index(zip_.get(), entry, 0);
  if (!file) failContent(path_, name, zip_error_code_zip(zip_get_error(zip_.get())));
  return {file, path_, name};
}

}  // namespace raymap
