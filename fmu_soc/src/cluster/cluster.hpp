// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock.hpp"
#include "cluster/dma.hpp"
#include "cluster/peripherals.hpp"
#include "hart/hart.hpp"
#include "memory/banks.hpp"
#include "memory/instruction_cache.hpp"
#include "stopwatch.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace mebots::soc {

/// How far cores and DMA of a cluster are from the memories of the SoC, in the cluster's ticks. It changes with the
/// clocks: the SoC has its own.
struct ClusterWays {
  std::vector<std::uint32_t> waits;  // of each port
  std::uint32_t refill_cycles = 0;   // of the instruction cache
  DmaTiming dma;
  std::uint32_t access_ticks = 1;  // that an access of a core keeps the way that it shares with others
};

/// What a cluster is made of; from the board and its chip.
struct ClusterSettings {
  unsigned cores = 0;
  std::size_t l1_region = 0;  // index in Memory::regions()
  unsigned l1_banks = 16;
  /// The order at L1 is that of the tree of its interconnect: of the number XOR a count of quanta. Else it rotates.
  bool arbitration_tree = false;
  /// Ticks of a quantum when several cores are awake or the DMA moves data.
  std::uint32_t quantum = 0;
  std::vector<MemoryPort> ports;  // of a core, L1 first; its banks are filled in here
  bool shares_way = false;        // to the SoC: a core's access there waits for those of others
  InstructionCacheSettings instruction_cache;
  std::uint32_t clock_hz = 0;
  /// Its registers; the DMA engine is the cluster's.
  std::function<std::unique_ptr<ClusterPeripherals>(ClusterDma& dma)> make_peripherals;
  bool has_gap8_interrupts = false;  // cores have the interrupts and CSRs of GAP8's
  DmaTiming dma;
  Timing timing;
  bool translate = true;  // hot code to host code; counts are the same without
};

/// Up to eight cores with their shared L1, event unit and DMA, in a clock domain of their own. Time is counted in ticks
/// of the cluster's clock, which never stops; a core that sleeps does not count cycles.
///
/// The cores run one after the other for a quantum: as many ticks as the board has it when several are awake or the DMA
/// moves data, kLongQuantum when one is alone. The banks of L1 serve cores and DMA in turns (source: MUX2_REQ of the
/// PULP platform's cluster_interconnect, a round robin between the channel of the cores and that of the DMA). Here the
/// DMA takes its cycles before the cores in one quantum, so that they wait. In the next one it takes them behind the
/// cores, so that it waits, a cycle at most. Who touches the event unit or the DMA stops before it and goes on when
/// nobody is behind. So those see all accesses in the order of their ticks (within a tick: of the cores). What a core
/// stores in RAM another one may see up to a quantum late or early. Cores that synchronise through the event unit see
/// all of it.
class Cluster {
 public:
  static constexpr std::uint64_t kLongQuantum = Banks::kLongestRun;
  /// More ticks than a core can be ahead of the start of the quantum that follows.
  static constexpr std::uint64_t kFarthestAhead = kLongQuantum + Banks::kLongestBlock;
  /// Ticks from an event to the first instruction of the core that it wakes. Source: GVSoC, event unit of pulp_open.
  static constexpr std::uint64_t kWakeLatency = 2;

  Cluster(Memory& memory, const ClusterSettings& settings, const InstructionEnergy& energy);
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  /// Called after a core stored into a watched word; true ends the run.
  void set_watcher(std::function<bool(std::uint32_t address)> watcher) { watcher_ = std::move(watcher); }

  /// What a core finds where neither memory nor the cluster's own registers are. Called with the time of its access; it
  /// may change what the rest of the chip does next.
  using Outside = std::function<BusReply(const ClusterAccess& access, Picoseconds now)>;
  void set_outside(Outside outside) { outside_ = std::move(outside); }

  unsigned cores() const { return static_cast<unsigned>(cores_.size()); }
  bool powered() const { return powered_.runs(); }

  /// Off: what the cores and devices knew is lost. On: cores start as its registers have it, our own at once at `boot`,
  /// in the first tick at or after `now`.
  void power_off(Picoseconds now);
  void power_on(Picoseconds now, std::uint32_t boot);
  /// Another frequency, from the first tick at or after `now` on.
  void set_clock(Picoseconds now, std::uint32_t hz);
  std::uint32_t clock_hz() const { return clock_.hz(); }
  /// Of a core: L1 first.
  const std::vector<MemoryPort>& ports() const { return settings_.ports; }
  /// From now on; between quanta.
  void set_ways(const ClusterWays& ways);

  /// When the cluster next does something by itself; kNever while all cores sleep and no transfer runs.
  Picoseconds next() const;
  /// `ticks` after a time.
  Picoseconds later(Picoseconds time, std::uint64_t ticks) const {
    return clock_.time_of(clock_.first_at(time) + ticks);
  }
  /// Runs quantum after quantum, none of which goes on behind `until`, which lies after next(). It ends when the next
  /// one would start after `last`, when something happened that the rest of the chip must know of, or when a core's
  /// active cycles have reached `cycle_limit`.
  void advance(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit);

  /// Access of the fabric controller at `now`, up to which the cluster must have been advanced.
  bool owns(std::uint32_t address) const;
  BusReply load(std::uint32_t address, Picoseconds now);
  BusReply load_event(std::uint32_t address, Picoseconds now);
  BusReply store(std::uint32_t address, Picoseconds now, std::uint32_t value);

  /// The fabric controller's event load can be answered; forgotten with the call.
  bool take_fabric_wake();
  /// When its interrupt line last went up, its event load was answered, or a core last reached outside.
  Picoseconds fabric_event_time() const { return fabric_event_time_; }
  bool interrupt() const { return powered() && peripherals_->interrupt(); }

  const Hart& hart(unsigned core) const;
  Hart& hart(unsigned core);
  /// When the core's next instruction starts, or its sleep began; while it is on. Of a sleep that began before the
  /// clock last changed, that change.
  Picoseconds core_time(unsigned core) const;
  /// How far the core has come that is farthest, awake or not; of a cluster that is off, when it went off.
  Picoseconds reached() const;
  /// When the core that faulted or stopped the run would have gone on.
  Picoseconds stop_time() const { return stop_time_; }
  /// Who watches this core from now on, or null. Not part of a state.
  void observe(unsigned core, Observer* observer);
  /// Sum over the cores since reset of the chip.
  Counters counters() const;
  /// The most cycles that one of them was awake.
  std::uint64_t longest_cycles() const;
  /// Time it was on, up to `now`, which may lie in the middle of the instruction that switches it on.
  Picoseconds powered_time(Picoseconds now) const { return powered_.up_to(now); }
  /// Time in which a core was awake or all of them waited for the DMA, up to `now`. A cluster that is behind `now`
  /// counts as going on as it is.
  Picoseconds busy_time(Picoseconds now) const { return busy_.up_to(now); }
  /// The core that cannot go on; -1 = none.
  int faulted_core() const { return faulted_core_; }
  /// A core's store into a watched word ended the run.
  bool stopped() const { return stopped_; }
  /// The core whose observer did; -1 = none.
  int core_stopped_by_observer() const { return core_stopped_by_observer_; }
  const ClusterDma& dma() const { return dma_; }
  /// That all cores share; null without one.
  const InstructionCache* instruction_cache() const { return instruction_cache_.get(); }

  void visit(state::Visitor& v);

 private:
  class Core;

  std::uint64_t run_quantum(std::uint64_t start, std::uint64_t until);
  std::uint64_t run_quantum_in_step(std::uint64_t start, std::uint64_t until);
  std::uint64_t finish_quantum(std::uint64_t end);
  void next_in_front();
  void share_banks();
  void drop_resume_points();
  void move_banks(std::uint64_t tick);
  std::uint64_t first_ready() const;
  void queue_cores(std::uint64_t end);
  void rotate_queue();
  void reorder_queue();
  void line_up(std::uint64_t end);
  std::uint64_t keep_in_step();
  void run_cores(std::uint64_t start, std::uint64_t end);
  void run_queue(std::size_t i, std::uint64_t start, std::uint64_t end);
  std::size_t note_round(std::size_t i, const Hart::RoundEnd& round);
  bool can_resume(const Hart& hart, std::uint64_t start);
  void run_core(Core& core, std::uint64_t end);
  void note_stop(Core& core, Stop stop);
  void ring(std::uint64_t tick);
  void spread_events(std::uint64_t tick);
  std::uint64_t next_tick() const;
  std::uint64_t tick_at(Picoseconds time) const { return clock_.first_at(time); }
  Picoseconds time_of_core_at(std::uint64_t tick) const { return clock_.time_of(std::max(tick, clock_.begin())); }
  void start_cores(std::uint64_t tick);
  void note_awake(std::uint64_t tick);
  void note_asleep(std::uint64_t tick);
  BusReply access(const ClusterAccess& access);
  BusReply access_outside(const ClusterAccess& access);

  ClusterSettings settings_;
  std::unique_ptr<InstructionCache> instruction_cache_;
  Banks banks_;
  Banks way_{1};         // to the SoC: one access a cycle, whose it may be
  DecodedCode decoded_;  // one for all cores: they run the same code
  ClusterDma dma_;
  std::unique_ptr<ClusterPeripherals> peripherals_;
  std::uint64_t alarm_ = kNoTick;  // when something next happens in them by itself; not part of a state
  /// Of each core: the tick in which its next instruction starts; kNoTick while it sleeps, or when there is none.
  std::array<std::uint64_t, kMostClusterCores> ready_{};
  std::vector<std::unique_ptr<Core>> cores_;
  unsigned awake_ = 0;            // of them
  std::vector<Core*> queue_;      // of this quantum: who runs without asking, who comes first at a bank in front
  bool in_step_ = false;          // all who are awake came to the end of their last quantum in translated code
  std::uint64_t last_ready_ = 0;  // then: the tick of the core that is farthest ahead
  std::function<bool(std::uint32_t)> watcher_;
  Outside outside_;
  Clock clock_;
  Stopwatch powered_;
  bool interrupt_ = false;  // what the line was
  bool fabric_woken_ = false;
  bool stopped_ = false;
  Picoseconds stop_time_ = 0;  // not part of a state
  /// DecodedCode::version() when resume points were last dropped for it: they are good in this one only.
  std::uint64_t version_ = 0;
  bool has_news_ = false;  // for the rest of the chip, in this quantum
  bool sharing_banks_ = false;
  std::int32_t faulted_core_ = -1;
  std::int32_t core_stopped_by_observer_ = -1;  // not part of a state
  std::uint32_t first_core_ = 0;                // of the next quantum, when all are awake
  bool dma_first_ = false;                      // in it, before the cores; else behind them
  Picoseconds fabric_event_time_ = 0;
  Stopwatch busy_;
  std::uint64_t last_asleep_ = 0;  // the tick in which the last core fell asleep, since it is busy
};

}  // namespace mebots::soc
