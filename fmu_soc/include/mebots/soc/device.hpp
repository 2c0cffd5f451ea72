// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <string_view>

namespace mebots::soc {

/// A device on the bus: registers, what it does by itself as time goes on, and the variables of the FMU that its entry
/// in the board file names. Calls come in the order of time.
///
///   entry of the board file -> kind -> device      once, when a chip is made; numbers begin at their `start`
///   variables of the FMU -> *input(name)           at the start of every step, then begin_step()
///   registers: load(), store()                     when a core accesses them
///   advance(next_event())                          as time goes on; interrupt() is looked at after each of these
///   *output(name) -> variables of the FMU          at the end of every step
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// A register access of the core at `now`; false = no such register, or not this way.
  virtual bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) = 0;
  virtual bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) = 0;
  /// A load or store of `size` bytes, less than a word, at any offset; false = words only. A store's value is the whole
  /// register of the core, a load's low bytes count. Loads come from the fabric controller only.
  virtual bool load_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/, unsigned /*size*/) {
    return false;
  }
  virtual bool store_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/, unsigned /*size*/) {
    return false;
  }

  /// Time has reached `now`, which is never beyond next_event().
  virtual void advance(Picoseconds /*now*/) {}
  /// When the device wants to be advanced. This and interrupt() change by what happens to a device, of the list above,
  /// and with the fabric controller's clock. Nobody asks for them again otherwise.
  virtual Picoseconds next_event() const { return kNever; }
  /// Level of its interrupt line.
  virtual bool interrupt() const { return false; }

  /// Where the device keeps a number of its entry's variables, whatever the type (Boolean: 0 and 1; enumeration: the
  /// item's value), or a text or bytes that come in. Asked for once, by the name in the board file; null = it has no
  /// such variable. Texts and bytes are valid until begin_step() returns.
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  /// A step begins at `now`: parameters and inputs have been set, and hold until the next one.
  virtual void begin_step(Picoseconds /*now*/) {}

  /// Energy since reset [J], at `now`.
  virtual double energy_j(Picoseconds /*now*/) const { return 0; }
  /// A picture that was asked for has not come yet: a chip asleep waits for it.
  virtual bool takes_picture() const { return false; }
  /// Name of the state that it is in, for those who watch; empty for a device that has only one.
  virtual std::string_view state_name() const { return {}; }
  /// The program has ended, or the chip has lost its supply.
  virtual void program_ended() {}

  /// Shows all that the device knows, its inputs included; see mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
