// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <string>

namespace mebots::soc {

/// Collects characters and prints lines. A line longer than kMaxLine is printed in pieces.
class Console final : public Device {
 public:
  static constexpr std::size_t kMaxLine = 1000;

  explicit Console(DeviceHost& host);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  /// Adds the character in the low byte.
  bool put(std::uint32_t value, Picoseconds now);
  /// Prints an unfinished line.
  void program_ended() override;
  void visit(state::Visitor& v) override;

 private:
  DeviceHost& host_;
  std::string line_;
};

}  // namespace mebots::soc
