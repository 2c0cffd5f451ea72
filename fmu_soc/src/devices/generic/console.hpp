// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <string>

namespace mebots::soc {

/// Collects the characters that the firmware writes, and prints complete lines. If a line is longer than kMaxLine,
/// prints the line in pieces.
class Console final : public Device {
 public:
  static constexpr std::size_t kMaxLine = 1000;

  explicit Console(DeviceHost& host);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  /// Appends the character in the low byte of `value`.
  bool put(std::uint32_t value, Picoseconds now);
  /// Prints the last line even if it has no end.
  void program_ended() override;
  void visit(state::Visitor& v) override;

 private:
  DeviceHost& host_;
  std::string line_;
};

}  // namespace mebots::soc
