// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chip.hpp"
#include "devices/device.hpp"

namespace mebots::soc {

/// Clock and voltage of the core as the firmware asks for them, and the way out of the firmware. A request
/// outside the chip's limits changes nothing and sets the refused bit.
class PowerManager final : public Device {
 public:
  static constexpr std::uint32_t kRefused = 1;

  PowerManager(const Chip& chip, std::uint32_t clock_hz, std::uint32_t voltage_mv)
      : chip_(chip), clock_hz_(clock_hz), voltage_mv_(voltage_mv) {}

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void save(state::Writer& writer) const override;
  void restore(state::Reader& reader) override;

  std::uint32_t clock_hz() const { return clock_hz_; }
  std::uint32_t voltage_mv() const { return voltage_mv_; }
  bool exited() const { return exited_; }
  std::int32_t exit_code() const { return exit_code_; }

 private:
  const Chip& chip_;
  std::uint32_t clock_hz_;
  std::uint32_t voltage_mv_;
  std::uint32_t status_ = 0;
  bool exited_ = false;
  std::int32_t exit_code_ = 0;
};

}  // namespace mebots::soc
