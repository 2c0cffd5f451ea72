// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// GAP8's event unit as the cluster's cores have it: for each core a buffer of 32 events, a mask of those that end a
/// wait and one of those that interrupt. For all of them: eight software events, eight barriers, mutexes and the
/// dispatcher, by which one core hands words to a team.
///
/// A wait is a p.elw. It ends when an event that the core's mask lets through is in its buffer; the barrier, the mutex
/// and the dispatcher raise events 16, 17 and 18 for those who wait. Sources: archi/eu/eu_v3.h for registers;
/// pulp-platform/event_unit_flex and GVSoC's eu_v3 for behaviour.
class ClusterEventUnit {
 public:
  static constexpr unsigned kDmaEvent = 8;
  static constexpr unsigned kDmaInterruptEvent = 9;
  static constexpr unsigned kTimerEvent = 10;  // of the low counter; of the high one, the next
  static constexpr unsigned kBarrierEvent = 16;
  static constexpr unsigned kMutexEvent = 17;
  static constexpr unsigned kDispatchEvent = 18;
  static constexpr unsigned kBarriers = 8;
  static constexpr unsigned kMutexes = 1;
  static constexpr unsigned kLines = 32;
  /// Words that wait in the dispatcher for a core; the oldest is lost when another comes.
  static constexpr std::size_t kDispatchWords = 8;

  explicit ClusterEventUnit(unsigned cores);

  /// A core's own registers, 0x000 to 0x3FF behind its short way (EU_*_DEMUX_OFFSET).
  BusReply own(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event);
  /// All cores' registers, 0x000 to 0x7FF, by the long way.
  BusReply shared(std::uint32_t offset, const std::uint32_t* stored);

  /// An event for the cores whose bits are set.
  void raise(std::uint32_t cores, unsigned event);

  std::uint32_t take_woken();
  std::uint32_t take_line_changes();
  /// What a core sees on its interrupt lines: the highest one only.
  std::uint32_t lines(unsigned core) const;
  void interrupt_taken(unsigned core, unsigned line);

  void visit(state::Visitor& v);

 private:
  enum class Wait : std::uint32_t { nothing, event, barrier, mutex, dispatch };

  struct Core {
    std::uint32_t buffer = 0;
    std::uint32_t event_mask = 0;
    std::uint32_t interrupt_mask = 0;
    std::uint32_t software_targets = 0;  // of an event that it raises and then waits
    Wait waits_for = Wait::nothing;
    bool has_mutex = false;  // it was handed over while the core waited
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
    std::uint32_t team = 0;     // who must come
    std::uint32_t arrived = 0;  // who has
    std::uint32_t targets = 0;  // who gets the event

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
  std::uint32_t mutex_message_ = 0;  // left by who unlocked it last
  std::uint32_t team_ = 0;           // of the dispatcher
  std::uint32_t woken_ = 0;
  std::uint32_t line_changes_ = 0;
};

}  // namespace mebots::soc::gap8_devices
