// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Base class of all devices on the bus. The chip calls all functions from one thread, in the order of simulated time.
/// This table shows when the chip calls the most important functions:
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

  /// Read and write a register at time `now`. Return false if the register does not exist or does not support the
  /// access.
  virtual bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) = 0;
  virtual bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) = 0;
  /// Read and write `size` bytes (1 or 2) at any offset. Return false if the device only supports accesses to whole
  /// words. For a store, `value` is the core's whole register. For a load, the chip uses the low `size` bytes of
  /// `value`. Only the fabric controller loads 1 or 2 bytes from a device.
  virtual bool load_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/, unsigned /*size*/) {
    return false;
  }
  virtual bool store_narrow(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/, unsigned /*size*/) {
    return false;
  }

  /// Returns true if a load at this offset does not change the results of next_event() and interrupt(), has no effect
  /// outside the device, and throws no exception. Programs that poll such a register are simulated faster, because the
  /// chip does not call next_event() and interrupt() after the load. The chip may repeat the load at the same time.
  virtual bool load_is_quiet(std::uint32_t /*offset*/) const { return false; }

  /// Processes the device's events up to time `now`. `now` is never after next_event().
  virtual void advance(Picoseconds /*now*/) {}
  /// Returns the time of the device's next event. The results of next_event() and interrupt() may only change in the
  /// functions that the class comment lists, and when the fabric controller's clock changes. The chip does not notice
  /// other changes.
  virtual Picoseconds next_event() const { return kNever; }
  /// Returns the level of the interrupt line.
  virtual bool interrupt() const { return false; }

  /// Return the storage of a variable, by its name in the board file, or null if the device has no such variable.
  /// input() and output() are for numbers, Booleans (0 or 1) and enumerations (value of the item). The other functions
  /// are for Strings and Binaries. The chip calls these functions when it is constructed, and keeps the pointers.
  /// Strings and Binaries are valid until begin_step() returns.
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  virtual const std::string* text_output(std::string_view /*variable*/) const { return nullptr; }
  /// Begins a communication step at time `now`. Parameters and inputs have been set, and do not change until the next
  /// step.
  virtual void begin_step(Picoseconds /*now*/) {}

  /// Returns the energy [J] that the device has used from reset to `now`.
  virtual double energy_j(Picoseconds /*now*/) const { return 0; }
  /// Returns true while a requested picture has not arrived. A sleeping chip waits for the picture.
  virtual bool takes_picture() const { return false; }
  /// Returns the name of the device's present state, for traces. Returns an empty text if the device has only one
  /// state.
  virtual std::string_view state_name() const { return {}; }
  /// Called when the program ends or when the chip loses its supply voltage.
  virtual void program_ended() {}

  /// Visits the whole state of the device, including its inputs; see mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
