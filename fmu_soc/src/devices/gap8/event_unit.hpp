// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"
#include "memory/bus.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// GAP8's event unit as the fabric controller has it: a buffer of 32 events, a mask of those that end a wait and one of
/// those that interrupt. The first of a queue of SoC events keeps event 27 up until it is read. Of the events that
/// interrupt the highest is presented; taking it clears it. Sources: archi/eu/eu_v3.h; behaviour of
/// event_unit_flex (pulp-platform), README and RTL.
class EventUnit {
 public:
  /// SoC events that wait; one that comes then is lost.
  static constexpr std::size_t kQueue = 8;

  explicit EventUnit(Signals& signals);
  EventUnit(const EventUnit&) = delete;
  EventUnit& operator=(const EventUnit&) = delete;

  /// The core's own registers, 0x00 to 0x3F, and its software events at 0x100.
  bool load(std::uint32_t offset, std::uint32_t& value);
  bool store(std::uint32_t offset, std::uint32_t value);
  /// A p.elw.
  BusReply load_event(std::uint32_t offset);
  /// Takes the next event of the SoC; bit 31 says that there was one.
  std::uint32_t take_soc_event();

  void raise(unsigned event);
  void queue_soc_event(unsigned event);
  /// The core takes an interrupt.
  void acknowledge(unsigned line);
  /// What the core sees on its lines: the highest one only.
  std::uint32_t lines() const;
  /// A wait can be answered now; forgotten with the call.
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

/// Its registers on the bus of the fabric controller's peripherals: those of the core at 0, software events at 0x600,
/// the queue of SoC events at 0x700.
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

/// The short way to the same registers, by which the core waits.
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

/// Returns the event unit of the board. Throws Error if no device before `entry` is one.
EventUnit& event_unit_before(const BoardDevice& entry, const DeviceSource& devices);

}  // namespace mebots::soc::gap8_devices
