// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Reads and writes the text that a line between two UARTs transfers in one communication step:
///
///     12 =8680556 a5@86805556 07@173611112
///
/// 12 is the number of bytes before this text since reset. =8680556 is the length of a bit [ps] of the bytes that
/// follow. a5@86805556 is the byte 0xa5, whose stop bit ended 86805556 ps after the start of the step. If no byte ended
/// in the step, the text is empty.
namespace mebots::soc {

inline constexpr Picoseconds kLongestUartBit = 1'000'000'000'000;

struct UartByte {
  Picoseconds end = 0;  // end of the stop bit [ps]: in a text since the start of the step, otherwise since reset
  Picoseconds bit = 0;  // length of a bit [ps]
  std::uint8_t value = 0;

  void visit(state::Visitor& v) {
    v("end", end);
    v("bit", bit);
    v("value", value);
  }
};

struct UartText {
  std::uint64_t first = 0;
  std::vector<UartByte> bytes;
};

class UartTextWriter {
 public:
  void clear() { text_.clear(); }
  /// Appends a byte. `number` is the count of bytes before it since reset.
  void add(std::uint64_t number, const UartByte& byte);
  const std::string& text() const { return text_; }

  void visit(state::Visitor& v) {
    v("text", text_);
    v("bit", bit_);
  }

 private:
  std::string text_;
  Picoseconds bit_ = 0;  // last length of a bit in the text
};

/// Parses a text into `result`. Throws Error with the variable's name if the text is invalid.
void read_uart_text(std::string_view name, std::string_view text, UartText& result);

}  // namespace mebots::soc
