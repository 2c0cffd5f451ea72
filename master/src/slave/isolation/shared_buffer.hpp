// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mebots::master::isolation {

/// Thrown if the other process has written invalid data.
class DamagedMemory : public Error {
 public:
  explicit DamagedMemory(const std::string& what) : Error(ErrorCode::fmu_lost, what) {}
};

/// Memory that two processes share. Both map the same anonymous file, which is freed after both have ended. The file
/// never shrinks, so that no process can cause faults in the other one.
class SharedBuffer {
 public:
  /// Creates a buffer of at least `size` bytes. Physical memory is used only for written bytes. Throws Error if the
  /// system cannot provide the memory.
  explicit SharedBuffer(const char* name, std::size_t size = 0);
  /// Maps a buffer of another process. `descriptor` is the file descriptor of the buffer in this process.
  explicit SharedBuffer(int descriptor);
  ~SharedBuffer();
  SharedBuffer(const SharedBuffer&) = delete;
  SharedBuffer& operator=(const SharedBuffer&) = delete;

  std::byte* data() { return data_; }
  std::size_t size() const { return mapped_; }
  int descriptor() const { return descriptor_; }
  /// Closes the descriptor after the other process has received it. This object then cannot map a larger size of the
  /// file.
  void close_descriptor();

  /// Makes the first `size` bytes usable. The file grows if necessary. Addresses in the buffer may change.
  void reserve(std::size_t size);
  /// Returns the first `size` bytes, which the other process has written. Throws DamagedMemory if the buffer is
  /// smaller.
  std::span<const std::byte> bytes(std::size_t size);

 private:
  void map(std::size_t size);
  std::size_t length() const;

  int descriptor_;  // -1 after close_descriptor()
  std::size_t final_length_ = 0;
  std::byte* data_ = nullptr;
  std::size_t mapped_ = 0;
};

class SharedWriter {
 public:
  explicit SharedWriter(SharedBuffer& buffer) : buffer_(&buffer) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { append(&value, sizeof value); }

  /// Writes the number of elements and the elements.
  template <typename T, std::size_t Extent>
  requires std::is_trivially_copyable_v<T>
  void put(std::span<T, Extent> values) {
    put(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  void put(std::string_view text) { put(std::span<const char>(text)); }
  void put_optional(std::optional<double> value) {
    put(value.has_value());
    put(value.value_or(0));
  }

  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
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

/// Reads the values of a SharedWriter. Checks all lengths, because the other process may be faulty.
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
  /// Reads values into an array. Throws DamagedMemory if the number of values differs from its size.
  template <typename T>
  void get(std::span<T> values) {
    if (count(sizeof(T)) != values.size()) fail();
    const auto bytes = take(values.size_bytes());
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  }
  /// Reads a Boolean. Every byte except 0 is true, because the other process may write any byte.
  bool get_flag() { return get<std::uint8_t>() != 0; }
  std::optional<double> get_optional() {
    const bool has_value = get_flag();
    const auto value = get<double>();
    return has_value ? std::optional(value) : std::nullopt;
  }
  std::string get_text() {
    const auto bytes = get_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// Reads bytes and returns a view of the buffer.
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
