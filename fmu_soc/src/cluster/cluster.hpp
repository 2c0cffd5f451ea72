// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "cluster/core.hpp"
#include "cluster/dma.hpp"
#include "cluster/peripherals.hpp"
#include "cluster/scheduler.hpp"
#include "cluster/settings.hpp"
#include "memory/banks.hpp"
#include "memory/instruction_cache.hpp"
#include "runs/decoded_code.hpp"
#include "runs/hart.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace mebots::soc {

/// Models up to eight cores that share an L1 memory, an event unit and a DMA. The cluster has its own clock and counts
/// time in ticks of this clock, also while all cores sleep. The rest of the chip counts time in picoseconds. Only this
/// class converts between ticks and picoseconds.
///
/// The scheduler runs each core for a quantum of ticks in turn. Accesses to the event unit and the DMA are in the order
/// of their ticks; accesses in the same tick are in the order of the cores. A core may see another core's store to RAM
/// up to one quantum too late or too early. Cores that synchronise through the event unit see all stores in order.
class Cluster final : private ClusterBus, private ClusterEvents {
 public:
  Cluster(Memory& memory, const ClusterSettings& settings, const InstructionEnergy& energy);
  ~Cluster() override = default;
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  /// Sets the function that is called after a core has stored into a word that the host watches, such as `tohost`. The
  /// run ends if the function returns true.
  void set_watcher(std::function<bool(std::uint32_t address)> watcher) { watcher_ = std::move(watcher); }

  /// Performs an access of a core at time `now` to an address outside memory and outside the cluster's registers. The
  /// access may change the time of the next event in the rest of the chip.
  using Outside = std::function<BusReply(const ClusterAccess& access, Picoseconds now)>;
  void set_outside(Outside outside) { outside_ = std::move(outside); }

  unsigned cores() const { return static_cast<unsigned>(cores_.size()); }
  bool powered() const { return powered_.runs(); }

  /// power_off() ends all activity. power_on() resets all cores and devices, and starts the cluster in the first tick
  /// at or after `now`. The cluster's registers determine the start address of each core. With MEbots' own devices, all
  /// cores start at `boot`.
  void power_off(Picoseconds now);
  void power_on(Picoseconds now, std::uint32_t boot);
  /// Sets the clock frequency, from the first tick at or after `now`.
  void set_clock(Picoseconds now, std::uint32_t hz);
  std::uint32_t clock_hz() const { return clock_.hz(); }
  const std::vector<MemoryPort>& ports() const { return settings_.ports; }
  /// Sets the latencies of the cluster's accesses to the SoC. Must be called between quanta.
  void set_latencies(const ClusterLatencies& latencies);

  /// Returns the time of the cluster's next activity. Returns kNever if the cluster is off or has stopped the run, or
  /// if all cores sleep and no event is due.
  Picoseconds next() const;
  /// Returns the time `ticks` ticks after the first tick at or after `time`.
  Picoseconds later(Picoseconds time, std::uint64_t ticks) const {
    return clock_.time_of(clock_.first_at(time) + ticks);
  }
  /// Runs quanta up to `until`, which must be after next(). Returns earlier if the next quantum would start after
  /// `last`, if an event has occurred that affects the rest of the chip, or if a core has reached `cycle_limit` active
  /// cycles.
  void advance(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit);

  /// Accesses of the fabric controller to the cluster's registers. owns() returns true if the cluster has registers at
  /// an address. Before an access, the cluster must have been advanced to `now`.
  bool owns(std::uint32_t address) const;
  BusReply load(std::uint32_t address, Picoseconds now);
  BusReply load_event(std::uint32_t address, Picoseconds now);
  BusReply store(std::uint32_t address, Picoseconds now, std::uint32_t value);

  /// Returns true if the event load for which the fabric controller waits can now complete. Returns true only once for
  /// each event load.
  bool take_fabric_wake();
  /// Returns the time of the last event that affects the rest of the chip: a rise of the interrupt line, the completion
  /// of the fabric controller's event load, or an access of a core to an address outside the cluster.
  Picoseconds fabric_event_time() const { return fabric_event_time_; }
  bool interrupt() const { return powered() && peripherals_->interrupt(); }

  const Hart& hart(unsigned core) const;
  Hart& hart(unsigned core);
  /// Returns the start time of the core's next instruction. For a sleeping core, returns the time at which its sleep
  /// began, or the time of the last change of the clock if that is later. The cluster must be on.
  Picoseconds core_time(unsigned core) const;
  /// Returns the time at which an active cycle starts. Since that cycle, the core must not have slept, and the clock
  /// must not have changed.
  Picoseconds core_time_at(unsigned core, std::uint64_t cycle) const;
  /// Returns the time of the core that is farthest ahead. If the cluster is off, returns the time at which it was
  /// switched off.
  Picoseconds reached() const;
  /// Returns the start time of the next instruction of the core that faulted or stopped the run.
  Picoseconds stop_time() const { return stop_time_; }
  /// Sets the observer of a core; null removes it. The observer is not part of a saved state.
  void observe(unsigned core, Observer* observer);
  /// Returns the sum of all cores' counters since reset of the chip.
  Counters counters() const;
  /// Returns the largest number of active cycles of any core.
  std::uint64_t longest_cycles() const;
  /// Returns how long the cluster was on until `now`. `now` may lie within the instruction that switches it on.
  Picoseconds powered_time(Picoseconds now) const { return powered_.up_to(now); }
  /// Returns how long, until `now`, a core was awake or all cores waited for the DMA. If the cluster has not reached
  /// `now`, assumes that its present state continues.
  Picoseconds busy_time(Picoseconds now) const { return busy_.up_to(now); }
  /// Returns the core that stopped because of a fault, or -1 if no core did.
  int faulted_core() const { return faulted_core_; }
  /// Returns true if a store into a word that the host watches, such as `tohost`, ended the run.
  bool stopped() const { return stopped_; }
  /// Returns the core whose observer ended the run, or -1 if no observer did.
  int core_stopped_by_observer() const { return core_stopped_by_observer_; }
  const ClusterDma& dma() const { return dma_; }
  unsigned l1_banks() const { return banks_.count(); }
  /// Returns the cores' instruction cache, or null if they have none.
  const InstructionCache* instruction_cache() const { return instruction_cache_.get(); }

  void visit(state::Visitor& v);

 private:
  /// Number of ticks from an event to the first instruction of the core that it wakes. Source: GVSoC, event unit of
  /// pulp_open.
  static constexpr std::uint64_t kWakeLatency = 2;

  // Functions that the cores call.
  BusReply access(const ClusterAccess& access) override;
  bool permits_at_once(std::uint64_t tick) override { return scheduler_.permits_at_once(tick); }
  std::uint32_t interrupt_taken(unsigned core, unsigned line) override;
  bool watched(std::uint32_t address) override { return watcher_ && watcher_(address); }
  BusReply access_outside(const ClusterAccess& access);
  // Functions that the scheduler calls.
  void alarm_rings(std::uint64_t tick) override;
  void transfers_end(std::uint64_t tick) override;
  bool core_stopped(ClusterCore& core, Stop stop) override;

  void spread_events(std::uint64_t tick);
  std::uint64_t next_tick() const;
  std::uint64_t tick_at(Picoseconds time) const { return clock_.first_at(time); }
  Picoseconds time_of_core_at(std::uint64_t tick) const { return clock_.time_of(std::max(tick, clock_.begin())); }
  void start_cores(std::uint64_t tick);
  void note_awake(std::uint64_t tick);
  void note_asleep(std::uint64_t tick);

  ClusterSettings settings_;
  std::unique_ptr<InstructionCache> instruction_cache_;
  Banks banks_;
  Banks soc_port_{1};    // port to the SoC, which performs one access of a core per cycle
  DecodedCode decoded_;  // decoded code, which all cores share
  ClusterDma dma_;
  std::unique_ptr<ClusterPeripherals> peripherals_;
  ClusterScheduler scheduler_;
  std::vector<std::unique_ptr<ClusterCore>> cores_;
  std::function<bool(std::uint32_t)> watcher_;
  Outside outside_;
  Clock clock_;
  Stopwatch powered_;
  bool interrupt_ = false;  // level of the interrupt line at the last check
  bool fabric_woken_ = false;
  bool stopped_ = false;
  Picoseconds stop_time_ = 0;  // not part of a state
  bool has_news_ = false;      // true if an event for the rest of the chip has occurred in this quantum
  std::int32_t faulted_core_ = -1;
  std::int32_t core_stopped_by_observer_ = -1;  // not part of a state
  Picoseconds fabric_event_time_ = 0;
  Stopwatch busy_;
  std::uint64_t last_asleep_ = 0;  // tick in which a core last fell asleep, or in which a transfer last ended
};

}  // namespace mebots::soc
