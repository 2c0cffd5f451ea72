// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

/// The result of an access outside RAM.
struct BusReply {
  enum class Kind : std::uint8_t {
    none,     // no device at this address: the instruction raises an exception
    done,     // the access was performed
    blocked,  // an event load without a pending event: the core sleeps before the instruction until it is woken
    later,    // another core must run first: no effect, and the core stops before the instruction
  };
  Kind kind = Kind::none;
  std::uint32_t value = 0;        // value of a load
  std::uint32_t wait_cycles = 0;  // latency in both directions
  bool is_quiet = false;  // true for a load that changes nothing outside the device, not even the time of an event

  static BusReply done(std::uint32_t value = 0, std::uint32_t wait_cycles = 0) {
    return {Kind::done, value, wait_cycles};
  }
};

/// Interface to the registers of devices. load() and store() access aligned words.
class Bus {
 public:
  virtual ~Bus() = default;
  /// These functions perform an access of the instruction that starts in the core's active cycle `cycle`. The address
  /// must be a multiple of 4.
  virtual BusReply load(std::uint32_t address, std::uint64_t cycle) = 0;
  virtual BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) = 0;
  /// Performs the load of a p.elw instruction, which may wait for an event.
  virtual BusReply load_event(std::uint32_t address, std::uint64_t cycle) { return load(address, cycle); }
  /// These functions access 1 or 2 bytes, or misaligned bytes within a word.
  virtual BusReply load_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, unsigned /*size*/) { return {}; }
  virtual BusReply store_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, std::uint32_t /*value*/,
                                unsigned /*size*/) {
    return {};
  }
  /// Loads `size` aligned bytes from a device, but only if the caller need not check for events afterwards: see
  /// Device::load_is_quiet(). Otherwise has no effect, and the kind of the reply is not `done`.
  virtual BusReply load_quietly(std::uint32_t /*address*/, std::uint64_t /*cycle*/, unsigned /*size*/) noexcept {
    return {};
  }
  /// Called when the core takes the interrupt of this line. Some event units then clear the event.
  virtual void interrupt_taken(unsigned /*line*/) {}
  /// Called after a store into a word that the host watches, such as `tohost`. The run ends with this store if the
  /// function returns true.
  virtual bool watched(std::uint32_t address) = 0;
  /// Called for an exception at the core's pc, such as an ebreak or ecall. Returns true if the exception was a call to
  /// the host and the host has executed it. The program then continues after the four bytes at the pc.
  virtual bool called_host(std::uint32_t /*cause*/) { return false; }
  /// True if an ecall may be a call to the host. Does not change during a run.
  virtual bool serves_environment_calls() const { return false; }
};

}  // namespace mebots::soc
