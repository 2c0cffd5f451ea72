// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/dma.hpp"
#include "cluster/peripherals.hpp"
#include "hart/data_path.hpp"
#include "hart/timing.hpp"
#include "memory/instruction_cache.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace mebots::soc {

/// Latencies of accesses by cores and DMA to the SoC's memories, in ticks of the cluster. They depend on the clocks of
/// cluster and SoC.
struct ClusterLatencies {
  /// Upper bound of access_ticks. A slow clock of the SoC makes access_ticks large.
  static constexpr std::uint32_t kMostAccessTicks = 512;

  std::vector<std::uint32_t> waits;  // wait ticks of each port in ClusterSettings::ports
  std::uint32_t refill_cycles = 0;   // ticks of a refill of the instruction cache
  DmaTiming dma;
  std::uint32_t access_ticks = 1;  // ticks for which an access of a core occupies the shared port
};

struct ClusterSettings {
  unsigned cores = 0;
  std::size_t l1_region = 0;  // index in Memory::regions()
  unsigned l1_banks = 16;
  /// Selects the order in which cores claim banks of L1 in a quantum. If true, the cores are sorted by core number XOR
  /// n, where n counts the quanta (arbitration tree). If false, each core in turn is first, and the others follow in
  /// the order of their numbers.
  bool arbitration_tree = false;
  /// Length of a quantum [ticks] if several cores are awake or the DMA moves data.
  std::uint32_t quantum = 0;
  std::vector<MemoryPort> ports;  // memories that a core can access, L1 first; ClusterCore adds the banks
  bool shares_soc_port = false;   // if true, a core's access to the SoC waits for accesses of other cores
  InstructionCacheSettings instruction_cache;
  std::uint32_t clock_hz = 0;
  /// Creates the cluster's registers. The DMA outlives the registers.
  std::function<std::unique_ptr<ClusterPeripherals>(ClusterDma& dma)> make_peripherals;
  bool has_gap8_interrupts = false;  // if true, the cores have GAP8's interrupts and CSRs
  DmaTiming dma;
  Timing timing;
  bool translate = true;  // if true, hot code is translated; this setting does not change cycle counts or results
};

}  // namespace mebots::soc
