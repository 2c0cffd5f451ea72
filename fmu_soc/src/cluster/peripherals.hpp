// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/bus.hpp"

#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace mebots::soc {

/// Who asks: cluster cores are 0 to 7, then comes the fabric controller.
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

/// Who hears that a transfer of the cluster's DMA has ended: `tag` is what it was started with.
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

/// What a cluster has beside cores, memory and DMA engine. That is the registers by which its cores wait for each other
/// and for the DMA, and whatever starts them. Calls come in the order of ticks; what an access did is asked for behind
/// it.
class ClusterPeripherals : public TransferListener {
 public:
  ClusterPeripherals() = default;
  ClusterPeripherals(const ClusterPeripherals&) = delete;
  ClusterPeripherals& operator=(const ClusterPeripherals&) = delete;
  ~ClusterPeripherals() override = default;

  /// Whether an access of a core, or of the fabric controller, to this address is theirs.
  virtual bool owns_of_core(std::uint32_t address) const = 0;
  virtual bool owns_of_fabric_controller(std::uint32_t address) const = 0;
  virtual BusReply access(const ClusterAccess& access) = 0;
  /// When something next happens in them by itself, and that it does. Only accesses change it.
  virtual std::uint64_t next_tick() const { return kNoTick; }
  virtual void advance(std::uint64_t /*tick*/) {}

  /// The cluster is switched on; `boot` is what the power manager says of it.
  virtual void reset(std::uint32_t boot) = 0;
  /// Cores that begin, each at boot_address(); forgotten with the call.
  virtual std::uint32_t take_started() = 0;
  virtual std::uint32_t boot_address(unsigned core) const = 0;
  /// Requesters whose event load can be answered now; forgotten with the call.
  virtual std::uint32_t take_woken() = 0;
  /// Level of the line to the fabric controller.
  virtual bool interrupt() const { return false; }
  /// Cores whose interrupt lines changed; forgotten with the call.
  virtual std::uint32_t take_line_changes() { return 0; }
  virtual std::uint32_t lines(unsigned /*core*/) const { return 0; }
  virtual void interrupt_taken(unsigned /*core*/, unsigned /*line*/) {}

  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::soc
