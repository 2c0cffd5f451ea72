// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/chip_host.hpp"
#include "mebots/soc/device.hpp"

namespace mebots::soc {

/// Models the registers with which the firmware sets clocks and voltage, switches the cluster, and ends its program. A
/// request outside the chip's limits changes nothing and sets the refused bit.
class PowerManager final : public Device {
 public:
  static constexpr std::uint32_t kRefused = 1;

  PowerManager(const Chip& chip, const PowerSettings& start, bool has_cluster)
      : chip_(chip), has_cluster_(has_cluster), settings_(start) {}

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override;

  const PowerSettings& settings() const { return settings_; }
  /// Clears the request for retention sleep. Must be called when the chip has woken.
  void woken() { settings_.retention = 0; }
  bool exited() const { return exited_; }
  std::int32_t exit_code() const { return exit_code_; }

 private:
  void change(std::uint32_t PowerSettings::*what, std::uint32_t value);

  const Chip& chip_;
  bool has_cluster_;
  PowerSettings settings_;
  std::uint32_t status_ = 0;
  bool exited_ = false;
  std::int32_t exit_code_ = 0;
};

}  // namespace mebots::soc
