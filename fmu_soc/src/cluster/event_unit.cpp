// SPDX-License-Identifier: Apache-2.0
#include "cluster/event_unit.hpp"

#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"

#include <type_traits>

namespace mebots::soc {
namespace {

namespace event_reg = board::event_unit;

/// Additional cycles of an event load that does not wait. Such a load takes 4 cycles in total. Source: CV32E40P user
/// manual.
constexpr std::uint32_t kEventLoadExtra = 3;
constexpr unsigned kSoftwareEventShift = 16;

}  // namespace

BusReply EventUnit::load(unsigned who, std::uint32_t offset) const {
  MEBOTS_ASSERT(who < cores_ || who == kFabricController);
  const auto& self = of_[who];
  switch (offset) {
    case event_reg::kEventWait:
      return BusReply::done(self.buffer & self.mask);
    case event_reg::kEventMask:
      return BusReply::done(self.mask);
    case event_reg::kEventBuffer:
      return BusReply::done(self.buffer);
    case event_reg::kBarrierCores:
      return BusReply::done(barrier_cores_);
    case event_reg::kForkEntry:
      return BusReply::done(fork_entry_);
    case event_reg::kForkArgument:
      return BusReply::done(fork_argument_);
    case event_reg::kForkCores:
      return BusReply::done(at_work_);
    case event_reg::kDispatchArgument:
      return BusReply::done(self.argument);
    case event_reg::kCoreId:
      return BusReply::done(who);
    case event_reg::kCoreCount:
      return BusReply::done(cores_);
    case event_reg::kStatus:
      return BusReply::done(status_);
    default:
      return {};
  }
}

BusReply EventUnit::load_event(unsigned who, std::uint32_t offset) {
  MEBOTS_ASSERT(who < cores_ || who == kFabricController);
  auto& self = of_[who];
  switch (offset) {
    case event_reg::kEventWait: {
      const auto events = self.buffer & self.mask;
      self.buffer &= ~events;
      return answer_or_sleep(self, events != 0, Wait::event, events);
    }
    case event_reg::kBarrierWait: {
      if (who == kFabricController) return {};
      if (self.waits_for != Wait::barrier) arrive(who);
      const bool open = self.barrier_open != 0;
      self.barrier_open = 0;
      return answer_or_sleep(self, open, Wait::barrier, 0);
    }
    case event_reg::kDispatchWait: {
      if (who == kFabricController) return {};
      const bool ready = self.dispatched != 0;
      self.dispatched = 0;
      return answer_or_sleep(self, ready, Wait::dispatch, fork_entry_);
    }
    default: {
      return load(who, offset);
    }
  }
}

BusReply EventUnit::answer_or_sleep(Requester& requester, bool ready, Wait what, std::uint32_t value) {
  requester.waits_for = ready ? Wait::nothing : what;
  if (!ready) return {BusReply::Kind::blocked};
  return BusReply::done(value, kEventLoadExtra);
}

bool EventUnit::store(unsigned who, std::uint32_t offset, std::uint32_t value) {
  MEBOTS_ASSERT(who < cores_ || who == kFabricController);
  auto& self = of_[who];
  switch (offset) {
    case event_reg::kEventMask:
      self.mask = value;
      return true;
    case event_reg::kEventClear:
      self.buffer &= ~value;
      return true;
    case event_reg::kSoftwareEvent:
      raise(value & ((1U << kRequesters) - 1), value >> kSoftwareEventShift & (event::kSoftwareEvents - 1));
      return true;
    case event_reg::kBarrierCores:
      barrier_cores_ = value & ((1U << cores_) - 1);
      return true;
    case event_reg::kForkEntry:
      fork_entry_ = value;
      return true;
    case event_reg::kForkArgument:
      fork_argument_ = value;
      return true;
    case event_reg::kForkCores:
      fork(who, value);
      return true;
    case event_reg::kJobDone:
      job_done(who);
      return true;
    case event_reg::kStatus:
      status_ &= ~value;
      return true;
    default:
      return false;
  }
}

void EventUnit::raise(std::uint32_t targets, unsigned event) {
  MEBOTS_ASSERT(event < 32, "an event is a bit of a word");
  for (unsigned who = 0; who < kRequesters; ++who) {
    if ((targets >> who & 1U) == 0) continue;
    of_[who].buffer |= 1U << event;
    if ((of_[who].buffer & of_[who].mask) != 0) wake(who, Wait::event);
  }
}

void EventUnit::wake(unsigned who, Wait what) {
  MEBOTS_ASSERT(who < kRequesters && what != Wait::nothing);
  if (of_[who].waits_for == what) woken_ |= 1U << who;
}

void EventUnit::fork(unsigned who, std::uint32_t cores) {
  const auto existing = (1U << cores_) - 1;
  if (who != kFabricController || cores == 0 || (cores & ~existing) != 0 || at_work_ != 0) {
    status_ |= kRefused;
    return;
  }
  at_work_ = cores;
  barrier_cores_ = cores;
  arrived_ = 0;
  for (unsigned core = 0; core < cores_; ++core) {
    if ((cores >> core & 1U) == 0) continue;
    of_[core].dispatched = 1;
    of_[core].argument = fork_argument_;
    wake(core, Wait::dispatch);
  }
}

void EventUnit::job_done(unsigned who) {
  MEBOTS_ASSERT(who < kRequesters);
  const auto before = at_work_;
  at_work_ &= ~(1U << who);
  if (before != 0 && at_work_ == 0) raise(1U << kFabricController, event::kJobDone);
}

void EventUnit::arrive(unsigned who) {
  MEBOTS_ASSERT(who < cores_, "the fabric controller has no barrier");
  arrived_ |= 1U << who;
  if ((arrived_ & barrier_cores_) != barrier_cores_) return;
  for (unsigned core = 0; core < cores_; ++core) {
    if ((arrived_ >> core & 1U) == 0) continue;
    of_[core].barrier_open = 1;
    if (core != who) wake(core, Wait::barrier);
  }
  arrived_ = 0;
}

void EventUnit::visit(state::Visitor& v) {
  v("requester", of_);
  v("barrier_cores", barrier_cores_);
  v("arrived", arrived_);
  v("fork_entry", fork_entry_);
  v("fork_argument", fork_argument_);
  v("at_work", at_work_);
  v("status", status_);
  v("woken", woken_);
}

}  // namespace mebots::soc
