// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// GAP8's SoC event generator: 64 events, and three masks for the fabric controller, the cluster and the peripherals (1
/// = masked). Software raises events 48 to 55. Event 56 is the rising edge of the reference clock. Source:
/// archi/soc_eu/soc_eu_v1.h.
class SocEvents final : public Device {
 public:
  using Deliver = std::function<void(unsigned event)>;

  /// `deliver` adds an event to the fabric controller's queue.
  SocEvents(Signals& signals, Deliver deliver);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kMasks = 6;  // for each of three receivers, events 32 to 63, then 0 to 31

  bool is_unmasked(unsigned event) const { return (masks_[event >= 32 ? 0 : 1] >> (event % 32) & 1U) == 0; }
  void raise(unsigned event) {
    if (is_unmasked(event)) deliver_(event);
  }

  Deliver deliver_;
  std::array<std::uint32_t, kMasks> masks_;
  std::int64_t edges_ = 0;  // edges of the reference clock that are handled
};

}  // namespace mebots::soc::gap8_devices
