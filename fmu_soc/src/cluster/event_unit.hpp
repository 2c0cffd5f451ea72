// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

/// Numbers of events: bits of EVENT_MASK and EVENT_BUFFER. 0 to 7 are the firmware's own.
namespace event {
inline constexpr unsigned kSoftwareEvents = 8;
inline constexpr unsigned kDmaDone = 8;
inline constexpr unsigned kJobDone = 17;
}  // namespace event

/// Lets cores wait for each other without spinning. It has events with a mask and a buffer for each, a barrier, and a
/// fork that hands an entry and an argument to idle cores. Each requester sees its own registers at the same addresses.
///
/// A p.elw of EVENT_WAIT, BARRIER_WAIT or DISPATCH_WAIT puts its core to sleep until the answer is there. The sleeper
/// is in woken() then, and asks again.
class EventUnit {
 public:
  /// FORK_CORES named a core that does not exist or is at work, or a cluster core wrote it.
  static constexpr std::uint32_t kRefused = 1;

  explicit EventUnit(unsigned cores) : cores_(cores) {}

  BusReply load(unsigned who, std::uint32_t offset) const;
  BusReply load_event(unsigned who, std::uint32_t offset);
  bool store(unsigned who, std::uint32_t offset, std::uint32_t value);

  /// An event for all requesters whose bits are set.
  void raise(std::uint32_t targets, unsigned event);

  /// Requesters whose event load can be answered now; forgets them.
  std::uint32_t take_woken() {
    const auto woken = woken_;
    woken_ = 0;
    return woken;
  }
  /// Level of the interrupt line to the fabric controller: one of its events is there and let through.
  bool interrupt() const { return (of_[kFabricController].buffer & of_[kFabricController].mask) != 0; }
  /// Cores that run a fork's entry.
  std::uint32_t at_work() const { return at_work_; }

  void visit(state::Visitor& v);

 private:
  enum class Wait : std::uint32_t { nothing, event, barrier, dispatch };
  struct Requester {
    std::uint32_t mask = 0;
    std::uint32_t buffer = 0;
    Wait waits_for = Wait::nothing;
    std::uint32_t barrier_open = 0;  // the barrier that it waits at has been passed
    std::uint32_t dispatched = 0;    // a fork has named it, and it has not taken the entry yet
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
