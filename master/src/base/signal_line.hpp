// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mebots::master {

/// A line of text that is composed without the heap: for signal handlers, and for a forked copy of a process. What does
/// not fit is cut.
class SignalLine {
 public:
  SignalLine& operator<<(std::string_view text) {
    for (const char c : text) {
      if (size_ < bytes_.size()) bytes_[size_++] = c;
    }
    return *this;
  }
  SignalLine& operator<<(std::int64_t number) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  std::string_view text() const { return {bytes_.data(), size_}; }
  void write_to(int descriptor) const { static_cast<void>(!::write(descriptor, bytes_.data(), size_)); }

 private:
  std::array<char, 1024> bytes_;
  std::size_t size_ = 0;
};

}  // namespace mebots::master
