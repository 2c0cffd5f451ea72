// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <string_view>

namespace mebots::soc {

/// A device on the bus: registers, and what it does by itself as time goes on. Calls come in the order of time.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// A register access of the core at `now`; false = no such register, or not this way.
  virtual bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) = 0;
  virtual bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) = 0;

  /// Time has reached `now`, which is never beyond next_event().
  virtual void advance(Picoseconds /*now*/) {}
  /// When the device wants to be advanced.
  virtual Picoseconds next_event() const { return kNever; }
  /// Level of its interrupt line.
  virtual bool interrupt() const { return false; }

  /// Name of the state that it is in, for those who watch; empty for a device that has only one.
  virtual std::string_view state_name() const { return {}; }

  /// Shows all that the device knows, its inputs included; see mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
