// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device.hpp"

namespace mebots::soc {

/// Models a timer that counts nanoseconds since reset. The interrupt line is active while time >= compare.
class Timer final : public Device {
 public:
  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool load_is_quiet(std::uint32_t /*offset*/) const override { return true; }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  bool interrupt() const override { return due_; }
  void visit(state::Visitor& v) override;

 private:
  Picoseconds compare_ps() const;

  static constexpr std::uint64_t kOff = ~std::uint64_t{0};
  std::uint64_t compare_ns_ = kOff;
  std::uint32_t latched_high_ = 0;
  bool due_ = false;
};

}  // namespace mebots::soc
