// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// GAP8's SoC event generator: 64 events, and three masks that say which the fabric controller, the cluster and the
/// peripherals do not hear of (1 = does not). Software raises events 48 to 55; the reference clock's rising edge is
/// event 56. Source: archi/soc_eu/soc_eu_v1.h.
class SocEvents final : public Device {
 public:
  using Deliver = std::function<void(unsigned event)>;

  /// `deliver`: to the fabric controller's queue.
  SocEvents(Signals& signals, Deliver deliver);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kMasks = 6;  // for each of three, events 32 to 63, then 0 to 31

  bool is_unmasked(unsigned event) const { return (masks_[event >= 32 ? 0 : 1] >> (event % 32) & 1U) == 0; }
  void raise(unsigned event) {
    if (is_unmasked(event)) deliver_(event);
  }

  Deliver deliver_;
  std::array<std::uint32_t, kMasks> masks_;
  std::int64_t edges_ = 0;  // of the reference clock, up to the last time that somebody looked
};

}  // namespace mebots::soc::gap8_devices
