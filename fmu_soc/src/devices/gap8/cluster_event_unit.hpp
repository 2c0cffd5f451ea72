// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models GAP8's event unit of the cluster's cores. Each core has a buffer of 32 events, a mask of events that end a
/// wait, and a mask of events that interrupt. All cores share eight software events, eight barriers, mutexes, and the
/// dispatcher, which passes words from one core to a group of cores.
///
/// A wait is a p.elw. The wait ends when the buffer contains an event of the core's mask. Barrier, mutex and dispatcher
/// raise events 16, 17 and 18 for waiting cores. Sources: archi/eu/eu_v3.h for registers; pulp-platform/event_unit_flex
/// and GVSoC's eu_v3 for behaviour.
class ClusterEventUnit {
 public:
  static constexpr unsigned kDmaEvent = 8;
  static constexpr unsigned kDmaInterruptEvent = 9;
  static constexpr unsigned kTimerEvent = 10;  // event of the low counter; the high counter raises the next event
  static constexpr unsigned kBarrierEvent = 16;
  static constexpr unsigned kMutexEvent = 17;
  static constexpr unsigned kDispatchEvent = 18;
  static constexpr unsigned kBarriers = 8;
  static constexpr unsigned kMutexes = 1;
  static constexpr unsigned kLines = 32;
  /// Maximum number of dispatcher words that wait for a core. A further word replaces the oldest one.
  static constexpr std::size_t kDispatchWords = 8;

  explicit ClusterEventUnit(unsigned cores);

  /// Serves a core's own registers, 0x000 to 0x3FF of its demultiplexed range (EU_*_DEMUX_OFFSET).
  BusReply own(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  /// Serves the registers of all cores, 0x000 to 0x7FF, on the peripheral bus.
  BusReply shared(std::uint32_t offset, const std::uint32_t* stored);

  /// Sets the event in the buffers of the cores whose bits are set in `cores`.
  void raise(std::uint32_t cores, unsigned event);

  std::uint32_t take_woken();
  std::uint32_t take_line_changes();
  /// Returns the interrupt lines of a core. Only the pending line with the highest number is active.
  std::uint32_t lines(unsigned core) const;
  void interrupt_taken(unsigned core, unsigned line);

  void visit(state::Visitor& v);

 private:
  enum class Wait : std::uint32_t { nothing, event, barrier, mutex, dispatch };

  struct Core {
    std::uint32_t buffer = 0;
    std::uint32_t event_mask = 0;
    std::uint32_t interrupt_mask = 0;
    std::uint32_t software_targets = 0;  // cores that receive the software event when this core starts to wait
    Wait waits_for = Wait::nothing;
    bool has_mutex = false;  // the mutex was passed to this core while it waited
    std::vector<std::uint32_t> dispatched;

    void visit(state::Visitor& v) {
      v("buffer", buffer);
      v("event_mask", event_mask);
      v("interrupt_mask", interrupt_mask);
      v("software_targets", software_targets);
      v("waits_for", waits_for);
      v("has_mutex", has_mutex);
      v("dispatched", dispatched);
    }
  };
  struct Barrier {
    std::uint32_t team = 0;     // cores that must arrive at the barrier
    std::uint32_t arrived = 0;  // cores that have arrived at the barrier
    std::uint32_t targets = 0;  // cores that receive the barrier's event

    void visit(state::Visitor& v) {
      v("team", team);
      v("arrived", arrived);
      v("targets", targets);
    }
  };

  BusReply core_register(Core& core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  BusReply software_event(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  BusReply barrier_register(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  BusReply mutex(unsigned core, const std::uint32_t* stored, bool event);
  BusReply dispatch(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  BusReply wait(Core& core, Wait what, bool clear, bool event);
  void arrive(Barrier& barrier, std::uint32_t cores);
  void open_if_complete(Barrier& barrier);
  void update(unsigned core);
  std::uint32_t all() const { return (1U << cores_) - 1; }

  unsigned cores_;
  std::array<Core, kMostClusterCores> of_;
  std::array<Barrier, kBarriers> barriers_;
  bool mutex_locked_ = false;
  std::uint32_t mutex_message_ = 0;  // word that the last unlock of the mutex has stored
  std::uint32_t team_ = 0;           // cores to which the dispatcher passes words
  std::uint32_t woken_ = 0;
  std::uint32_t line_changes_ = 0;
};

}  // namespace mebots::soc::gap8_devices
