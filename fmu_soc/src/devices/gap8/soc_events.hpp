// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// Models GAP8's SoC event generator. It has 64 events, and three masks: for the fabric controller, the cluster and the
/// peripherals. A mask bit of 1 blocks the event. Software raises events 48 to 55. Event 56 is the rising edge of the
/// reference clock. Source: archi/soc_eu/soc_eu_v1.h.
class SocEvents final : public Device {
 public:
  using Deliver = std::function<void(unsigned event)>;

  /// `deliver` must append an event to the fabric controller's queue.
  SocEvents(Signals& signals, Deliver deliver);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  /// Three receivers, each with a word for events 32 to 63 and a word for events 0 to 31.
  static constexpr std::size_t kMasks = 6;

  bool is_unmasked(unsigned event) const { return (masks_[event >= 32 ? 0 : 1] >> (event % 32) & 1U) == 0; }
  void raise(unsigned event) {
    if (is_unmasked(event)) deliver_(event);
  }

  Deliver deliver_;
  std::array<std::uint32_t, kMasks> masks_;
  std::int64_t edges_ = 0;  // number of edges of the reference clock that were processed
};

}  // namespace mebots::soc::gap8_devices
