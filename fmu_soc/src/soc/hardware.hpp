// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "board/chip.hpp"
#include "board/settings.hpp"
#include "cluster/cluster.hpp"
#include "devices/core/chip_host.hpp"
#include "elf/elf.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "runs/hart.hpp"
#include "soc/device_set.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>

namespace mebots::soc {

/// The cores and memories of a chip, and the connections between them.
class Hardware {
 public:
  /// `board` and `chip` must outlive this object. `bus` performs accesses outside the memories.
  Hardware(const BoardDescription& board, const Chip& chip, const Settings& settings, Bus& bus);
  Hardware(const Hardware&) = delete;
  Hardware& operator=(const Hardware&) = delete;

  /// Adds the cluster, if both board and settings define one.
  void add_cluster(const Settings& settings, DeviceHost& host);
  /// Connects the fabric controller to its memories, and to those of the cluster if the cluster is on.
  void connect_memories();
  /// Sets the latencies of the cluster's accesses to the SoC, which depend on the clocks of cluster and SoC.
  void set_latencies(std::uint32_t soc_hz);
  /// Copies each segment of the program to its load address. The program's start-up code must copy the segment to its
  /// run address. Throws Error if a segment is outside the memories. A segment without bytes may also be at the address
  /// of a device.
  void load_program(const Elf& program, const DeviceSet& devices);
  /// Writes bytes to memory between two instructions. Returns false without effect if no memory contains all of the
  /// bytes.
  bool poke(std::uint32_t address, std::span<const std::uint8_t> bytes);

  const Chip& chip() const { return chip_; }
  const BoardDescription& board() const { return board_; }
  Memory& memory() { return memory_; }
  const Memory& memory() const { return memory_; }
  /// Returns the fabric controller's instruction cache, or null if it has none.
  InstructionCache* instruction_cache() { return instruction_cache_.get(); }
  const InstructionCache* instruction_cache() const { return instruction_cache_.get(); }
  Hart& controller() { return controller_; }
  const Hart& controller() const { return controller_; }
  /// Returns the cluster, or null if the chip has none.
  Cluster* cluster() { return cluster_.get(); }
  const Cluster* cluster() const { return cluster_.get(); }
  /// Returns the fabric controller's interrupt line for events of the cluster, or -1 if they use none.
  int cluster_interrupt() const { return cluster_interrupt_; }
  unsigned harts() const { return 1 + (cluster_ ? cluster_->cores() : 0); }
  Hart& hart(unsigned number) {
    return number == kFabricControllerHart ? controller_ : cluster_->hart(core_of_hart(number));
  }
  const Hart& hart(unsigned number) const {
    return number == kFabricControllerHart ? controller_ : std::as_const(*cluster_).hart(core_of_hart(number));
  }

  void visit(state::Visitor& v);

 private:
  std::uint32_t wait_of_controller(std::size_t memory) const;
  bool has_latencies() const;
  void choose_peripherals(ClusterSettings& cluster, DeviceHost& host);
  /// Returns true if a memory contains this range, at its own address or at its alias.
  bool runs_in_memory(std::uint32_t address, std::uint32_t size) const;
  [[noreturn]] void fail_outside(const Elf& program, const ElfSegment& segment, std::string_view what,
                                 std::uint32_t address, std::uint32_t size) const;

  const Chip& chip_;
  const BoardDescription& board_;
  Memory memory_;
  std::unique_ptr<InstructionCache> instruction_cache_;
  DecodedCode decoded_;
  Hart controller_;
  std::unique_ptr<Cluster> cluster_;
  int cluster_interrupt_ = -1;
};

}  // namespace mebots::soc
