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

/// How far cores and DMA of a cluster are from the memories of the SoC, in the cluster's ticks. It changes with the
/// clocks: the SoC has its own.
struct ClusterLatencies {
  /// The way to the SoC is taken no longer by one access, however slow the SoC's clock is.
  static constexpr std::uint32_t kMostAccessTicks = 512;

  std::vector<std::uint32_t> waits;  // of each port
  std::uint32_t refill_cycles = 0;   // of the instruction cache
  DmaTiming dma;
  std::uint32_t access_ticks = 1;  // for which an access of a core occupies the shared port
};

/// The settings of a cluster, from the board and its chip.
struct ClusterSettings {
  unsigned cores = 0;
  std::size_t l1_region = 0;  // index in Memory::regions()
  unsigned l1_banks = 16;
  /// The order at L1 is that of the tree of its interconnect: of the number XOR a count of quanta. Else it rotates.
  bool arbitration_tree = false;
  /// Ticks of a quantum when several cores are awake or the DMA moves data.
  std::uint32_t quantum = 0;
  std::vector<MemoryPort> ports;  // of a core, L1 first; its banks are filled in by the core
  bool shares_soc_port = false;   // to the SoC: a core's access waits for those of other cores
  InstructionCacheSettings instruction_cache;
  std::uint32_t clock_hz = 0;
  /// Its registers; the DMA engine is the cluster's.
  std::function<std::unique_ptr<ClusterPeripherals>(ClusterDma& dma)> make_peripherals;
  bool has_gap8_interrupts = false;  // cores have the interrupts and CSRs of GAP8's
  DmaTiming dma;
  Timing timing;
  bool translate = true;  // hot code to host code; counts are the same without
};

}  // namespace mebots::soc
