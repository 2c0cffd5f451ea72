// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

/// What a core reaches outside the RAM: registers of devices, words only.
class Bus {
 public:
  virtual ~Bus() = default;
  /// A 4-byte aligned access by the instruction that starts in active cycle `cycle` of the core.
  /// False: nothing answers there, or not to this kind of access.
  virtual bool load(std::uint32_t address, std::uint64_t cycle, std::uint32_t& value) = 0;
  virtual bool store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) = 0;
  /// Called after a store into a watched word. True: the run ends with this store.
  virtual bool watched(std::uint32_t address) = 0;
};

}  // namespace mebots::soc
