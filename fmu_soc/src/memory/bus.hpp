// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

/// What comes back from an access outside the RAM.
struct BusReply {
  enum class Kind : std::uint8_t {
    none,     // nothing answers there, or not to this kind of access: the instruction traps
    done,     // carried out
    blocked,  // an event load whose event has not come: the core sleeps before the instruction until it is woken
    later,    // others must go first: nothing happened, the core stops before the instruction
  };
  Kind kind = Kind::none;
  std::uint32_t value = 0;        // of a load
  std::uint32_t wait_cycles = 0;  // of the way there and back

  static BusReply done(std::uint32_t value = 0, std::uint32_t wait_cycles = 0) {
    return {Kind::done, value, wait_cycles};
  }
};

/// What a core reaches outside the RAM: registers of devices, words only.
class Bus {
 public:
  virtual ~Bus() = default;
  /// A 4-byte aligned access by the instruction that starts in active cycle `cycle` of the core.
  virtual BusReply load(std::uint32_t address, std::uint64_t cycle) = 0;
  virtual BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) = 0;
  /// Likewise a p.elw, which may wait for an event.
  virtual BusReply load_event(std::uint32_t address, std::uint64_t cycle) { return load(address, cycle); }
  /// A load or store of 1 or 2 bytes, or one that is not aligned within a word.
  virtual BusReply load_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, unsigned /*size*/) { return {}; }
  virtual BusReply store_narrow(std::uint32_t /*address*/, std::uint64_t /*cycle*/, std::uint32_t /*value*/,
                                unsigned /*size*/) {
    return {};
  }
  /// The core takes the interrupt of this line: an event unit lets go of the event.
  virtual void interrupt_taken(unsigned /*line*/) {}
  /// Called after a store into a watched word. True: the run ends with this store.
  virtual bool watched(std::uint32_t address) = 0;
  /// The instruction at the core's pc is an ebreak. True: the program called the host, which has answered, and goes on
  /// behind it.
  virtual bool called_host() { return false; }
};

}  // namespace mebots::soc
