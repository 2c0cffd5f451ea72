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

/// Latencies of cores and DMA to the SoC's memories, in ticks of the cluster. These latencies change with the clocks of
/// cluster and SoC.
struct ClusterLatencies {
  /// Upper bound of access_ticks, for a slow clock of the SoC.
  static constexpr std::uint32_t kMostAccessTicks = 512;

  std::vector<std::uint32_t> waits;  // of each port
  std::uint32_t refill_cycles = 0;   // of the instruction cache
  DmaTiming dma;
  std::uint32_t access_ticks = 1;  // ticks for which an access of a core occupies the shared port
};

/// The settings of a cluster, from the board and its chip.
struct ClusterSettings {
  unsigned cores = 0;
  std::size_t l1_region = 0;  // index in Memory::regions()
  unsigned l1_banks = 16;
  /// Selects the order in which cores claim banks of L1 in a quantum. If true, cores are in the order of core number
  /// XOR n, where n counts the quanta. This is the order of an arbitration tree. If false, each core in turn is first
  /// in a quantum, and the others follow in the order of their numbers.
  bool arbitration_tree = false;
  /// Length of a quantum in ticks if several cores are awake or the DMA moves data.
  std::uint32_t quantum = 0;
  std::vector<MemoryPort> ports;  // memories of a core, L1 first; the core adds the banks
  bool shares_soc_port = false;   // port to the SoC: an access of a core waits for those of other cores
  InstructionCacheSettings instruction_cache;
  std::uint32_t clock_hz = 0;
  /// Creates the registers of the cluster. The cluster owns the DMA engine.
  std::function<std::unique_ptr<ClusterPeripherals>(ClusterDma& dma)> make_peripherals;
  bool has_gap8_interrupts = false;  // cores have the interrupts and CSRs of GAP8's cores
  DmaTiming dma;
  Timing timing;
  bool translate = true;  // translate hot code; the counts are the same without
};

}  // namespace mebots::soc
