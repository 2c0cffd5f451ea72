// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/bus.hpp"

#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace mebots::soc {

/// Number of a requester: 0 to 7 are the cluster's cores, 8 is the fabric controller.
inline constexpr unsigned kMostClusterCores = 8;
inline constexpr unsigned kFabricController = kMostClusterCores;
inline constexpr unsigned kRequesters = kMostClusterCores + 1;

// Numbers of harts: 0 is the fabric controller, n + 1 is core n of the cluster. Within the cluster, core n has number
// n. mhartid reads another value on GAP8.

inline constexpr unsigned kFabricControllerHart = 0;
/// Among the numbers of the cluster's cores.
inline constexpr int kFabricControllerCore = -1;

inline constexpr std::size_t kMostHarts = 1 + kMostClusterCores;

constexpr unsigned hart_of_core(int core) {
  return static_cast<unsigned>(core - kFabricControllerCore);
}

/// Of a hart that is not the fabric controller.
constexpr unsigned core_of_hart(unsigned hart) {
  return hart - hart_of_core(0);
}

/// A tick that never comes.
inline constexpr std::uint64_t kNoTick = std::numeric_limits<std::uint64_t>::max();

/// Listener for the end of a DMA transfer; `tag` is that of its start.
class TransferListener {
 public:
  virtual ~TransferListener() = default;
  virtual void transfer_ended(unsigned who, std::uint32_t tag, std::uint64_t tick) = 0;
};

/// An access of a cluster core, or of the fabric controller, to the cluster's registers.
struct ClusterAccess {
  unsigned who = 0;
  std::uint32_t address = 0;
  std::uint64_t tick = 0;
  const std::uint32_t* stored = nullptr;  // null = a load
  bool event = false;                     // a p.elw, which may wait
  unsigned size = 4;                      // bytes; less only of a store
};

/// The cluster's registers, by which its cores start and wait for each other and for the DMA. Calls are in the order of
/// ticks. The caller queries the effects of an access after it.
class ClusterPeripherals : public TransferListener {
 public:
  ClusterPeripherals() = default;
  ClusterPeripherals(const ClusterPeripherals&) = delete;
  ClusterPeripherals& operator=(const ClusterPeripherals&) = delete;
  ~ClusterPeripherals() override = default;

  /// True if an access of a core, or of the fabric controller, to this address belongs to them.
  virtual bool owns_of_core(std::uint32_t address) const = 0;
  virtual bool owns_of_fabric_controller(std::uint32_t address) const = 0;
  virtual BusReply access(const ClusterAccess& access) = 0;
  /// The tick of their next event, and the event itself. Only accesses change the tick.
  virtual std::uint64_t next_tick() const { return kNoTick; }
  virtual void advance(std::uint64_t /*tick*/) {}

  /// Called when the cluster is switched on; `boot` comes from the power manager.
  virtual void reset(std::uint32_t boot) = 0;
  /// Returns, once, the cores that start, each at boot_address().
  virtual std::uint32_t take_started() = 0;
  virtual std::uint32_t boot_address(unsigned core) const = 0;
  /// Returns, once, the requesters whose event load can be answered now.
  virtual std::uint32_t take_woken() = 0;
  /// Returns the level of the line to the fabric controller.
  virtual bool interrupt() const { return false; }
  /// Returns, once, the cores whose interrupt lines changed.
  virtual std::uint32_t take_line_changes() { return 0; }
  virtual std::uint32_t lines(unsigned /*core*/) const { return 0; }
  virtual void interrupt_taken(unsigned /*core*/, unsigned /*line*/) {}

  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
