// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

/// Converts values to bytes in the byte order of this machine. A state can be restored only on the same kind of
/// machine.
namespace mebots::state {

/// Appends values to a byte vector.
class Writer {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { append(&value, sizeof value); }

  void put(const std::string& text) { put(std::span<const char>(text)); }

  /// Writes the number of elements before the elements.
  template <typename T, std::size_t Extent>
  requires std::is_trivially_copyable_v<T>
  void put(std::span<T, Extent> values) {
    put(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }

  template <typename T>
  void put(const std::vector<T>& values) {
    put(std::span<const T>(values));
  }

  void append(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads the values that a Writer wrote, in the same order. Throws Error (state_damaged) if the bytes end too early.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value;
    copy_to(&value, sizeof value);
    return value;
  }

  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void get(T& value) { copy_to(&value, sizeof value); }

  void get(std::string& text) {
    text.resize(count(1));
    copy_to(text.data(), text.size());
  }

  template <typename T>
  void get(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    copy_to(values.data(), values.size() * sizeof(T));
  }

  bool at_end() const { return bytes_.empty(); }

  /// Reads the number of elements of a list. Throws Error if fewer elements remain in the bytes.
  std::size_t count(std::size_t element_size) {
    const auto n = get<std::uint64_t>();
    if (n > bytes_.size() / element_size)
      throw Error(ErrorCode::state_damaged,
                  "a saved state is cut short or damaged: a list is longer than the bytes left");
    return static_cast<std::size_t>(n);
  }

  void copy_to(void* target, std::size_t size) {
    if (size > bytes_.size())
      throw Error(ErrorCode::state_damaged, "a saved state is cut short or damaged: bytes are missing at its end");
    if (size != 0) std::memcpy(target, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace mebots::state
