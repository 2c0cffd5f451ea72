// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device.hpp"

#include <functional>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Collects characters and hands out lines. A line longer than kMaxLine goes out in pieces.
class Console final : public Device {
 public:
  static constexpr std::size_t kMaxLine = 1000;
  using Sink = std::function<void(std::string_view line)>;

  explicit Console(Sink sink);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override;

  /// Hands out what stands in an unfinished line: the firmware has ended.
  void flush();

 private:
  Sink sink_;
  std::string line_;
};

}  // namespace mebots::soc
