// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

/// The result of an access outside RAM.
struct BusReply {
  enum class Kind : std::uint8_t {
    none,     // no device answers this access: the instruction traps
    done,     // carried out
    blocked,  // an event load whose event is not pending: the core sleeps before the instruction until it is woken
    later,    // another core must run first: no effect; the core stops before the instruction
  };
  Kind kind = Kind::none;
  std::uint32_t value = 0;        // of a load
  std::uint32_t wait_cycles = 0;  // latency in both directions
  bool is_quiet = false;          // a load that changes nothing outside the device: no schedule has changed

  static BusReply done(std::uint32_t value = 0, std::uint32_t wait_cycles = 0) {
    return {Kind::done, value, wait_cycles};
  }
};

/// The bus to registers of devices. load() and store() access whole words.
class Bus {
 public:
  virtual ~Bus() = default;
  /// Performs a 4-byte aligned access of the instruction that starts in active cycle `cycle` of the core.
  virtual BusReply load(std::uint32_t address, std::uint64_t cycle) = 0;
  virtual BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) = 0;
  /// Performs the load of a p.elw instruction, which may wait for an event.
  virtual BusReply load_event(std::uint32_t address, std::uint64_t cycle) { return load(address, cycle); }
  /// Loads 1 or 2 bytes, or misaligned bytes within a word.
  virtual BusReply load_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, unsigned /*size*/) { return {}; }
  virtual BusReply store_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, std::uint32_t /*value*/,
                                unsigned /*size*/) {
    return {};
  }
  /// Loads `size` aligned bytes if the load is quiet. In all other cases, has no effect, and the reply has another kind
  /// than `done`. Throws no exception.
  virtual BusReply load_quietly(std::uint32_t /*address*/, std::uint64_t /*cycle*/, unsigned /*size*/) noexcept {
    return {};
  }
  /// Called when the core takes the interrupt of this line, for event units that then clear the event.
  virtual void interrupt_taken(unsigned /*line*/) {}
  /// Called after a store into a watched word. If the function returns true, the run ends with this store.
  virtual bool watched(std::uint32_t address) = 0;
  /// Called for an exception at the core's pc, such as an ebreak or ecall. Returns true if the exception was a call to
  /// the host, which has been served. In this case, the program continues after the four bytes at the pc.
  virtual bool called_host(std::uint32_t /*cause*/) { return false; }
};

}  // namespace mebots::soc
