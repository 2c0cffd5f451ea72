// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"
#include "memory/bus.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models GAP8's event unit of the fabric controller. It has a buffer of 32 events, a mask of events that end a wait,
/// and a mask of events that interrupt. Event 27 is set as long as the queue of SoC events is not empty. If several
/// events are set in both the buffer and the interrupt mask, the core sees only the event with the highest number. When
/// the core takes the interrupt, the event is cleared. Sources: archi/eu/eu_v3.h; behaviour of event_unit_flex
/// (pulp-platform), README and RTL.
class EventUnit {
 public:
  /// Maximum number of SoC events in the queue. If the queue is full, a new event is lost.
  static constexpr std::size_t kQueue = 8;

  explicit EventUnit(Signals& signals);
  EventUnit(const EventUnit&) = delete;
  EventUnit& operator=(const EventUnit&) = delete;

  /// Serve the core's own registers at 0x00 to 0x3F, and its software events at 0x100.
  bool load(std::uint32_t offset, std::uint32_t& value);
  bool store(std::uint32_t offset, std::uint32_t value);
  BusReply load_event(std::uint32_t offset);
  /// Removes and returns the next SoC event of the queue. Bit 31 is set if the queue contained an event.
  std::uint32_t take_soc_event();

  void raise(unsigned event);
  void queue_soc_event(unsigned event);
  /// Clears the event whose interrupt the core has taken.
  void acknowledge(unsigned line);
  /// Returns the interrupt lines of the core. Only the pending line with the highest number is active.
  std::uint32_t lines() const;
  /// Returns true if an event has ended the core's wait since the last call.
  bool take_wake();

  void visit(state::Visitor& v);

 private:
  void refresh();

  std::uint32_t buffer_ = 0;
  std::uint32_t event_mask_ = 0;
  std::uint32_t interrupt_mask_ = 0;
  bool waits_ = false;
  std::vector<std::uint8_t> queue_;
};

/// Maps the event unit to the fabric controller's peripheral bus. The registers of the core are at 0, the software
/// events at 0x600, and the queue of SoC events at 0x700.
class EventUnitPort final : public Device {
 public:
  explicit EventUnitPort(Signals& signals) : unit_(signals) {}

  EventUnit& unit() { return unit_; }
  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override { unit_.visit(v); }

 private:
  EventUnit unit_;
};

/// Maps the event unit to the demultiplexed range, in which the core waits for events.
class EventUnitDemux final : public Device {
 public:
  explicit EventUnitDemux(EventUnit& unit) : unit_(unit) {}

  EventUnit& unit() { return unit_; }
  bool load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) override {
    return unit_.load(offset, value);
  }
  bool store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) override {
    return unit_.store(offset, value);
  }
  void visit(state::Visitor& /*v*/) override {}

 private:
  EventUnit& unit_;
};

/// Returns the event unit of the board. Throws Error if no device before `entry` in the board file is an event unit.
EventUnit& event_unit_before(const BoardDevice& entry, const DeviceSource& devices);

}  // namespace mebots::soc::gap8_devices
