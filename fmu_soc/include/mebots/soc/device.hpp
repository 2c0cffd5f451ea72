// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mebots::soc {

/// A device on the bus: registers, events in time, and the variables of the FMU that its entry in the board file names.
/// All calls come from one thread, in the order of time.
///
///   entry of the board file -> kind -> device      once, at construction of the chip; numbers have their `start`
///   variables of the FMU -> *input(name)           at the start of every step, then begin_step()
///   registers: load(), store()                     when a core accesses them
///   advance(next_event())                          at the device's next event; interrupt() is queried after each call
///   *output(name) -> variables of the FMU          at the end of every step
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// These functions perform an access of the core to a register at time `now`. They return false if there is no such
  /// register, or if the register does not support the access.
  virtual bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) = 0;
  virtual bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) = 0;
  /// Serve an access of `size` bytes (1 or 2) at any offset. Return false if the device only serves words. For a store,
  /// `value` is the core's whole register. For a load, the low bytes of `value` are used. Only the fabric controller
  /// makes such loads.
  virtual bool load_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/, unsigned /*size*/) {
    return false;
  }
  virtual bool store_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/, unsigned /*size*/) {
    return false;
  }

  /// True if a load at this offset changes neither next_event() nor interrupt(), nor anything outside the device, and
  /// throws no exception. The chip does not query the device after such a load, so a program that polls the register is
  /// simulated faster. The chip may repeat the load at the same time.
  virtual bool load_is_quiet(std::uint32_t /*offset*/) const { return false; }

  /// Runs the device's events up to `now`, which is never after next_event().
  virtual void advance(Picoseconds /*now*/) {}
  /// Returns the time of the device's next event. The results of this function and of interrupt() may only change in
  /// the functions listed above, or if the fabric controller's clock changes. The chip queries them again only after
  /// such a call or change.
  virtual Picoseconds next_event() const { return kNever; }
  /// Returns the level of the interrupt line.
  virtual bool interrupt() const { return false; }

  /// Return the storage of one of the entry's variables by its name in the board file; null if the device has no such
  /// variable. input() and output() are for numbers of all types (Boolean: 0 and 1; enumeration: the item's value). The
  /// other functions are for texts and bytes. Each function is called once, at construction of the chip. Texts and
  /// bytes are valid until begin_step() returns.
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  virtual const std::string* text_output(std::string_view /*variable*/) const { return nullptr; }
  /// Begins a step at `now`. Parameters and inputs have been set, and stay constant until the next step.
  virtual void begin_step(Picoseconds /*now*/) {}

  /// Returns the energy since reset up to `now` [J].
  virtual double energy_j(Picoseconds /*now*/) const { return 0; }
  /// True while a requested picture has not arrived. A sleeping chip waits for it.
  virtual bool takes_picture() const { return false; }
  /// Returns the name of the device's present state, for traces. If the device has only one state, returns an empty
  /// text.
  virtual std::string_view state_name() const { return {}; }
  /// Called when the program has ended, or the chip has lost its supply.
  virtual void program_ended() {}

  /// Visits the whole state of the device, with its inputs; see mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
