// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/uart_text.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <charconv>
#include <iterator>
#include <system_error>

namespace mebots::soc {
namespace {

class UartTextReader {
 public:
  UartTextReader(std::string_view name, std::string_view text) : name_(name), text_(text), rest_(text) {}

  bool done() const { return rest_.empty(); }

  bool take(char expected) {
    if (rest_.empty() || rest_.front() != expected) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void require(char expected) {
    if (!take(expected)) fail();
  }

  std::uint64_t number(std::uint64_t most, int base = 10) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value, base);
    if (error != std::errc() || value > most) fail();
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  [[noreturn]] void fail() const {
    constexpr std::size_t kShown = 80;
    throw Error(ErrorCode::invalid_value,
                fmt::format("{} = \"{}{}\" is not valid at character {}. Expected is a text such as \"12 =8680556 "
                            "a5@86805556\": number of the first byte, length of a bit [ps], and each byte with the "
                            "time of its end [ps]; connect it to the output of another UART",
                            name_, text_.substr(0, kShown), text_.size() > kShown ? "..." : "",
                            text_.size() - rest_.size() + 1));
  }

 private:
  std::string_view name_;
  std::string_view text_;
  std::string_view rest_;
};

}  // namespace

void UartTextWriter::add(std::uint64_t number, const UartByte& byte) {
  auto out = std::back_inserter(text_);
  if (text_.empty()) {
    fmt::format_to(out, "{}", number);
    bit_ = 0;
  }
  if (byte.bit != bit_) fmt::format_to(out, " ={}", byte.bit);
  bit_ = byte.bit;
  fmt::format_to(out, " {:02x}@{}", byte.value, byte.end);
}

void read_uart_text(std::string_view name, std::string_view text, UartText& result) {
  constexpr std::uint64_t kMostNumber = std::uint64_t{1} << 53;
  constexpr std::uint64_t kLongestStep = 3'600'000'000'000'000;  // [ps]
  result.bytes.clear();
  if (text.empty()) return;
  UartTextReader reader(name, text);
  result.first = reader.number(kMostNumber);
  Picoseconds bit = 0;
  Picoseconds last = 0;
  while (!reader.done()) {
    reader.require(' ');
    if (reader.take('=')) {
      bit = static_cast<Picoseconds>(reader.number(kLongestUartBit));
      continue;
    }
    const auto value = static_cast<std::uint8_t>(reader.number(0xff, 16));
    reader.require('@');
    const auto end = static_cast<Picoseconds>(reader.number(kLongestStep));
    if (end < last || bit == 0) reader.fail();
    last = end;
    result.bytes.push_back({end, bit, value});
  }
  if (result.bytes.empty()) reader.fail();
}

}  // namespace mebots::soc
