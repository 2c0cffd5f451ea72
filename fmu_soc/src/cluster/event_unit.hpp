// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

/// Numbers of the events. Each is a bit of EVENT_MASK and EVENT_BUFFER. Events 0 to 7 are free for the firmware.
namespace event {
inline constexpr unsigned kSoftwareEvents = 8;
inline constexpr unsigned kDmaDone = 8;
inline constexpr unsigned kJobDone = 17;
}  // namespace event

/// Synchronises cores without spinning. Provides events with a mask and a buffer for each core, a barrier, and a fork,
/// which passes an entry address and an argument to idle cores. Each requester sees its own registers at the same
/// addresses.
///
/// A p.elw of EVENT_WAIT, BARRIER_WAIT or DISPATCH_WAIT puts its core to sleep if the result is not ready. When it is
/// ready, take_woken() returns the core, which then repeats the load.
class EventUnit {
 public:
  /// Status bit that is set after an invalid fork: FORK_CORES was written by a cluster core, is 0, or selects a core
  /// that does not exist, or a core still executes a fork.
  static constexpr std::uint32_t kRefused = 1;

  explicit EventUnit(unsigned cores) : cores_(cores) {}

  BusReply load(unsigned who, std::uint32_t offset) const;
  BusReply load_event(unsigned who, std::uint32_t offset);
  bool store(unsigned who, std::uint32_t offset, std::uint32_t value);

  /// Sets the event in the buffers of all requesters whose bit is set in `targets` (0 to 7: cores, 8: fabric
  /// controller).
  void raise(std::uint32_t targets, unsigned event);

  /// Returns a mask of the cores whose event loads have become ready since the last call. Bit 8 is the fabric
  /// controller.
  std::uint32_t take_woken() {
    const auto woken = woken_;
    woken_ = 0;
    return woken;
  }
  /// Returns the level of the interrupt line to the fabric controller. The line is active if an event of the fabric
  /// controller is pending and enabled.
  bool interrupt() const { return (of_[kFabricController].buffer & of_[kFabricController].mask) != 0; }
  /// Returns a mask of the cores that execute the present fork.
  std::uint32_t at_work() const { return at_work_; }

  void visit(state::Visitor& v);

 private:
  enum class Wait : std::uint32_t { nothing, event, barrier, dispatch };
  struct Requester {
    std::uint32_t mask = 0;
    std::uint32_t buffer = 0;
    Wait waits_for = Wait::nothing;
    std::uint32_t barrier_open = 0;  // 1 if the barrier is complete and the core has not read BARRIER_WAIT since then
    /// 1 if a fork has selected the core and the core has not read DISPATCH_WAIT since then.
    std::uint32_t dispatched = 0;
    std::uint32_t argument = 0;

    void visit(state::Visitor& v) {
      v("mask", mask);
      v("buffer", buffer);
      v("waits_for", waits_for);
      v("barrier_open", barrier_open);
      v("dispatched", dispatched);
      v("argument", argument);
    }
  };

  BusReply answer_or_sleep(Requester& requester, bool ready, Wait what, std::uint32_t value);
  void fork(unsigned who, std::uint32_t cores);
  void job_done(unsigned who);
  void arrive(unsigned who);
  void wake(unsigned who, Wait what);

  unsigned cores_;
  std::array<Requester, kRequesters> of_{};
  std::uint32_t barrier_cores_ = 0;
  std::uint32_t arrived_ = 0;
  std::uint32_t fork_entry_ = 0;
  std::uint32_t fork_argument_ = 0;
  std::uint32_t at_work_ = 0;
  std::uint32_t status_ = 0;
  std::uint32_t woken_ = 0;
};

}  // namespace mebots::soc
