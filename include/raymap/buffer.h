#pragma once

#include <raymap/export.h>

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace raymap {

/// Allocates `bytes` bytes, aligned for SIMD and on huge pages where the system grants them. Throws
/// `Error(Memory)`.
RAYMAP_API void* allocatePages(size_t bytes);
/// Frees the memory that `allocatePages` returned for `bytes` bytes; null is allowed.
RAYMAP_API void freePages(void* memory, size_t bytes);

/// A plain array with uninitialised elements. It keeps its memory when it shrinks, so that a field made every
/// frame allocates nothing. It moves, and copies only by `clone`.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;
  explicit Buffer(size_t size) { resizeUninitialized(size); }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer() { freePages(data_, capacityBytes()); }

  /// Sets the size. All contents are undefined afterwards if the capacity had to grow.
  void resizeUninitialized(size_t size) {
    if (size > capacity_) {
      freePages(data_, capacityBytes());
      data_ = nullptr;
      size_ = capacity_ = 0;
      data_ = static_cast<T*>(allocatePages(size * sizeof(T)));
      capacity_ = size;
    }
    size_ = size;
  }
  /// Frees the memory.
  void release() { Buffer().swap(*this); }
  /// Returns a copy.
  Buffer clone() const {
    Buffer copy(size_);
    std::uninitialized_copy_n(data_, size_, copy.data_);
    return copy;
  }
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  size_t size() const { return size_; }
  size_t capacityBytes() const { return capacity_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  T& operator[](size_t i) { return data_[i]; }
  const T& operator[](size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  operator std::span<T>() { return {data_, size_}; }
  operator std::span<const T>() const { return {data_, size_}; }

 private:
  T* data_ = nullptr;
  size_t size_ = 0;
  size_t capacity_ = 0;
};

}  // namespace raymap
