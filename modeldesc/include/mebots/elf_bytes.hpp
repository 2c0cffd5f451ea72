// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace mebots {

/// Reads structures from the bytes of an ELF file, which may be truncated. The bytes must outlive this object.
class ElfBytes {
 public:
  /// `name` is the file's name in errors. `code` is the code of all errors.
  ElfBytes(std::span<const std::uint8_t> bytes, std::string name, ErrorCode code)
      : bytes_(bytes), name_(std::move(name)), code_(code) {}

  [[noreturn]] void fail(std::string_view what) const { throw Error(code_, fmt::format("{}: {}", name_, what)); }

  bool has_magic() const {
    constexpr std::array<std::uint8_t, 4> kMagic = {0x7f, 'E', 'L', 'F'};
    return bytes_.size() >= kMagic.size() && std::ranges::equal(bytes_.first(kMagic.size()), kMagic);
  }

  bool has(std::uint64_t offset, std::uint64_t size) const {
    return offset <= bytes_.size() && size <= bytes_.size() - offset;
  }

  /// Returns `size` bytes from `offset` on. If the file is too short, throws Error that mentions `what`.
  std::span<const std::uint8_t> part(std::uint64_t offset, std::uint64_t size, std::string_view what) const {
    if (!has(offset, size)) {
      fail(fmt::format("the file is cut short: {} needs bytes {} to {} of {}", what, offset, offset + size,
                       bytes_.size()));
    }
    return bytes_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
  }

  /// Copies the structure at `offset`. Throws the same errors as part().
  template <typename T>
  T get(std::uint64_t offset, std::string_view what) const {
    T value;
    std::memcpy(&value, part(offset, sizeof value, what).data(), sizeof value);
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::string name_;
  ErrorCode code_;
};

}  // namespace mebots
