// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Reads and writes the texts that a line between two UARTs transfers. A text contains the bytes of one communication
/// step:
///
///     12 =8680556 a5@86805556 07@173611112
///
/// 12 is the number of the first byte since reset. =8680556 is the length of a bit [ps] of the bytes that follow.
/// a5@86805556 is the byte 0xa5, whose stop bit ended 86805556 ps after the start of the step. The text is empty if no
/// byte ended in the step.
namespace mebots::soc {

inline constexpr Picoseconds kLongestUartBit = 1'000'000'000'000;

struct UartByte {
  Picoseconds end = 0;  // end of the stop bit, since the start of the step in a text, and otherwise since reset
  Picoseconds bit = 0;  // length of a bit
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

/// Builds the text that contains the bytes of one step.
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
  Picoseconds bit_ = 0;  // length of a bit that was written last
};

/// Parses a text into `result`. Throws Error that names the variable `name` if the text has another form.
void read_uart_text(std::string_view name, std::string_view text, UartText& result);

}  // namespace mebots::soc
