// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/bus.hpp"

#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace mebots::soc {

/// Numbers of the requesters: 0 to 7 are the cluster's cores, and 8 is the fabric controller.
inline constexpr unsigned kMostClusterCores = 8;
inline constexpr unsigned kFabricController = kMostClusterCores;
inline constexpr unsigned kRequesters = kMostClusterCores + 1;

// Numbers of the chip's harts: 0 is the fabric controller, and n + 1 is core n of the cluster. On GAP8, mhartid
// contains other values.

inline constexpr unsigned kFabricControllerHart = 0;
/// Number of the fabric controller in places where the cluster's cores are numbered from 0.
inline constexpr int kFabricControllerCore = -1;

inline constexpr std::size_t kMostHarts = 1 + kMostClusterCores;

constexpr unsigned hart_of_core(int core) {
  return static_cast<unsigned>(core - kFabricControllerCore);
}

/// Returns the cluster core with this hart number. The hart must not be the fabric controller.
constexpr unsigned core_of_hart(unsigned hart) {
  return hart - hart_of_core(0);
}

inline constexpr std::uint64_t kNoTick = std::numeric_limits<std::uint64_t>::max();

/// Called at the end of a DMA transfer. `tag` is the value that was returned when the transfer was started.
class TransferListener {
 public:
  virtual ~TransferListener() = default;
  virtual void transfer_ended(unsigned who, std::uint32_t tag, std::uint64_t tick) = 0;
};

/// Describes an access of a cluster core or of the fabric controller to the cluster's registers.
struct ClusterAccess {
  unsigned who = 0;
  std::uint32_t address = 0;
  std::uint64_t tick = 0;
  const std::uint32_t* stored = nullptr;  // value that is stored; null for a load
  bool event = false;                     // true for a p.elw, which may wait
  unsigned size = 4;                      // bytes; only a store may have less than 4
};

/// Registers with which cores start other cores, and wait for other cores and for the DMA. The caller must make all
/// calls in the order of their ticks. After each access, it must query the effects with take_started(), take_woken(),
/// interrupt() and take_line_changes().
class ClusterPeripherals : public TransferListener {
 public:
  ClusterPeripherals() = default;
  ClusterPeripherals(const ClusterPeripherals&) = delete;
  ClusterPeripherals& operator=(const ClusterPeripherals&) = delete;
  ~ClusterPeripherals() override = default;

  /// Return true if an access to this address, by a cluster core or by the fabric controller, is an access to the
  /// cluster's registers.
  virtual bool owns_of_core(std::uint32_t address) const = 0;
  virtual bool owns_of_fabric_controller(std::uint32_t address) const = 0;
  virtual BusReply access(const ClusterAccess& access) = 0;
  /// Returns the tick of the next event of these registers, at which advance() must be called. Only access(), advance()
  /// and reset() change this tick.
  virtual std::uint64_t next_tick() const { return kNoTick; }
  virtual void advance(std::uint64_t /*tick*/) {}

  /// Called when the cluster is switched on. `boot` is the start address from the power manager's registers.
  virtual void reset(std::uint32_t boot) = 0;
  /// Returns a mask of the cores that were started since the last call. Each of them starts at its boot_address().
  virtual std::uint32_t take_started() = 0;
  virtual std::uint32_t boot_address(unsigned core) const = 0;
  /// Returns a mask of the cores whose event loads have become ready since the last call. Bit 8 is the fabric
  /// controller.
  virtual std::uint32_t take_woken() = 0;
  /// Returns the level of the interrupt line to the fabric controller.
  virtual bool interrupt() const { return false; }
  /// Returns a mask of the cores whose interrupt lines have changed since the last call.
  virtual std::uint32_t take_line_changes() { return 0; }
  virtual std::uint32_t lines(unsigned /*core*/) const { return 0; }
  virtual void interrupt_taken(unsigned /*core*/, unsigned /*line*/) {}

  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
