#include "io/field/gzip.h"

#include <zlib.h>

#include <algorithm>

namespace raymap {

namespace {

class Inflater {
 public:
  explicit Inflater(std::shared_ptr<InputFile> file) : file_(std::move(file)) {
    // 15 is the largest window; adding 32 makes zlib detect zlib and gzip headers.
    constexpr int kAnyHeader = 15 + 32;
    if (inflateInit2(&stream_, kAnyHeader) != Z_OK)
      throw Error(ErrorCode::Memory, file_->path().string() + ": no memory to inflate it");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  void read(void* to, size_t count) {
    auto* out = static_cast<Bytef*>(to);
    while (count > 0) {
      if (stream_.avail_in == 0) refill();
      const auto piece = static_cast<uInt>(std::min<size_t>(count, size_t{1} << 30));
      stream_.next_out = out;
      stream_.avail_out = piece;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      const size_t made = piece - stream_.avail_out;
      out += made;
      count -= made;
      if (status != Z_OK && count > 0)
        throwInvalid(file_->path(), status == Z_STREAM_END ? "its compressed data ends early"
                                                           : "its compressed data is damaged");
    }
  }

 private:
  void refill() {
    const auto count = std::min<uint64_t>(file_->remaining(), input_.size());
    if (count == 0) throwInvalid(file_->path(), "its compressed data ends early");
    file_->read(input_.data(), count);
    stream_.next_in = input_.data();
    stream_.avail_in = static_cast<uInt>(count);
  }

  std::shared_ptr<InputFile> file_;
  std::vector<Bytef> input_ = std::vector<Bytef>(size_t{1} << 16);
  z_stream stream_{};
};

}  // namespace

ReadBytes inflated(std::shared_ptr<InputFile> file) {
  return [inflater = std::make_shared<Inflater>(std::move(file))](void* to, size_t count) {
    inflater->read(to, count);
  };
}

}  // namespace raymap
