// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mebots::master::isolation {

/// What the other process wrote makes no sense: it is broken, or means harm.
class DamagedMemory : public Error {
 public:
  explicit DamagedMemory(const std::string& what) : Error(ErrorCode::fmu_lost, what) {}
};

/// Memory that two processes see: an anonymous file, mapped by both, gone with the last of them. It grows and never
/// shrinks, so that neither side can pull it from under the other.
class SharedBuffer {
 public:
  /// Makes one of at least `size` bytes, which take memory once they are written. Throws Error when the system has no
  /// memory for it.
  explicit SharedBuffer(const char* name, std::size_t size = 0);
  /// Maps one that another process made and handed over.
  explicit SharedBuffer(int descriptor);
  ~SharedBuffer();
  SharedBuffer(const SharedBuffer&) = delete;
  SharedBuffer& operator=(const SharedBuffer&) = delete;

  std::byte* data() { return data_; }
  std::size_t size() const { return mapped_; }
  int descriptor() const { return descriptor_; }
  /// Closes the descriptor after another process has got it. The file's length is then taken as final.
  void close_descriptor();

  /// Makes the first `size` bytes usable, and the file longer where it must be. Addresses may change.
  void reserve(std::size_t size);
  /// The first `size` bytes, as the other process wrote them. Throws DamagedMemory when there are not so many.
  std::span<const std::byte> bytes(std::size_t size);

 private:
  void map(std::size_t size);
  std::size_t length() const;

  int descriptor_;  // -1 after close_descriptor()
  std::size_t final_length_ = 0;
  std::byte* data_ = nullptr;
  std::size_t mapped_ = 0;
};

/// Appends values to a shared buffer.
class SharedWriter {
 public:
  explicit SharedWriter(SharedBuffer& buffer) : buffer_(&buffer) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { append(&value, sizeof value); }

  /// The count, then the elements.
  template <typename T, std::size_t Extent>
  requires std::is_trivially_copyable_v<T>
  void put(std::span<T, Extent> values) {
    put(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  void put(std::string_view text) { put(std::span<const char>(text)); }

  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Takes back what was put after the first `size` bytes.
  void cut(std::size_t size) { size_ = size; }

 private:
  void append(const void* data, std::size_t size) {
    if (size_ + size > buffer_->size()) buffer_->reserve(size_ + size);
    MEBOTS_ASSERT(size_ + size <= buffer_->size());
    if (size != 0) std::memcpy(buffer_->data() + size_, data, size);
    size_ += size;
  }

  SharedBuffer* buffer_;
  std::size_t size_ = 0;
};

/// Reads back what a SharedWriter wrote. The other process may be broken: every length is checked.
class SharedReader {
 public:
  explicit SharedReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> get_vector() {
    std::vector<T> values(count(sizeof(T)));
    const auto bytes = take(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  /// Into an array whose length is known.
  template <typename T>
  void get(std::span<T> values) {
    if (count(sizeof(T)) != values.size()) fail();
    const auto bytes = take(values.size_bytes());
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  }
  std::string get_text() {
    const auto bytes = get_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// A view into the buffer.
  std::span<const std::byte> get_bytes() { return take(count(1)); }
  bool at_end() const { return bytes_.empty(); }

 private:
  [[noreturn]] static void fail() {
    throw DamagedMemory("the shared memory between master and FMU process is damaged");
  }
  std::size_t count(std::size_t element_size) {
    const auto n = get<std::uint64_t>();
    if (n > bytes_.size() / element_size) fail();
    return static_cast<std::size_t>(n);
  }
  std::span<const std::byte> take(std::size_t size) {
    if (size > bytes_.size()) fail();
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  std::span<const std::byte> bytes_;
};

}  // namespace mebots::master::isolation
