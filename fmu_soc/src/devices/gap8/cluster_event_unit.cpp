// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/cluster_event_unit.hpp"

#include "devices/gap8/event_unit_registers.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <bit>

namespace mebots::soc::gap8_devices {
namespace {

namespace reg = event_unit_reg;

/// Core number of an access through the peripheral bus.
constexpr unsigned kNoCore = kMostClusterCores;

/// Additional cycles of an event load whose result is available. Such a load takes 4 cycles in total. Source: CV32E40P
/// user manual.
constexpr std::uint32_t kEventLoadExtra = 3;

BusReply load_only(std::uint32_t value, const std::uint32_t* stored) {
  return stored == nullptr ? BusReply::done(value) : BusReply{};
}

/// Accesses a mask, either directly (`which` = 0) or through its register that clears (4) or sets bits.
BusReply mask_register(std::uint32_t& mask, std::uint32_t which, const std::uint32_t* stored) {
  if (stored == nullptr) return which == 0 ? BusReply::done(mask) : BusReply{};
  mask = which == 0 ? *stored : which == 4 ? mask & ~*stored : mask | *stored;
  return BusReply::done();
}

}  // namespace

ClusterEventUnit::ClusterEventUnit(unsigned cores) : cores_(cores) {
  MEBOTS_ASSERT(cores > 0 && cores <= kMostClusterCores);
}

BusReply ClusterEventUnit::own(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event) {
  MEBOTS_ASSERT(core < cores_);
  BusReply reply;
  if (offset < reg::kCoreBytes) {
    reply = core_register(of_[core], offset, stored, event);
  } else if (offset >= reg::kDispatch && offset < reg::kMutex) {
    reply = dispatch(core, offset, stored, event);
  } else if (offset >= reg::kMutex && offset < reg::kMutex + 4 * kMutexes) {
    reply = mutex(core, stored, event);
  } else if (offset >= reg::kTriggerSoftwareEvent && offset < reg::kBarriers) {
    reply = software_event(core, offset - reg::kTriggerSoftwareEvent, stored, event);
  } else if (offset >= reg::kBarriers && offset < reg::kShortEnd) {
    reply = barrier_register(core, offset - reg::kBarriers, stored, event);
  }
  update(core);
  return reply;
}

BusReply ClusterEventUnit::shared(std::uint32_t offset, const std::uint32_t* stored) {
  if (offset < reg::kCoreBytes * cores_) {
    const auto core = offset / reg::kCoreBytes;
    const auto reply = core_register(of_[core], offset % reg::kCoreBytes, stored, false);
    update(core);
    return reply;
  }
  if (offset >= reg::kLongBarriers && offset < reg::kLongSoftwareEvents) {
    return barrier_register(kNoCore, offset - reg::kLongBarriers, stored, false);
  }
  if (offset >= reg::kLongSoftwareEvents && offset < reg::kLongSoftwareEvents + reg::kTriggerBytes) {
    return software_event(kNoCore, offset - reg::kLongSoftwareEvents, stored, false);
  }
  return {};
}

BusReply ClusterEventUnit::core_register(Core& core, std::uint32_t offset, const std::uint32_t* stored, bool event) {
  switch (offset) {
    case reg::kMask:
    case reg::kMaskAnd:
    case reg::kMaskOr:
      return mask_register(core.event_mask, offset - reg::kMask, stored);
    case reg::kMaskIrq:
    case reg::kMaskIrqAnd:
    case reg::kMaskIrqOr:
      return mask_register(core.interrupt_mask, offset - reg::kMaskIrq, stored);
    case reg::kSoftwareTargets:
    case reg::kSoftwareTargetsAnd:
    case reg::kSoftwareTargetsOr:
      return mask_register(core.software_targets, offset - reg::kSoftwareTargets, stored);
    case reg::kStatus:  // 1: the clock of the core runs
      return load_only(core.waits_for == Wait::nothing ? 1 : 0, stored);
    case reg::kBuffer:
      return load_only(core.buffer, stored);
    case reg::kBufferMasked:
      return load_only(core.buffer & core.event_mask, stored);
    case reg::kBufferIrqMasked:
      return load_only(core.buffer & core.interrupt_mask, stored);
    case reg::kBufferClear:
      if (stored == nullptr) return {};
      core.buffer &= ~*stored;
      return BusReply::done();
    case reg::kEventWait:
    case reg::kEventWaitClear:
      if (stored != nullptr) return {};
      return wait(core, Wait::event, offset == reg::kEventWaitClear, event);
    default:
      return {};
  }
}

/// Performs a load that may wait for events. A p.elw returns the events that ended its wait; other loads return the
/// present events.
BusReply ClusterEventUnit::wait(Core& core, Wait what, bool clear, bool event) {
  const auto events = core.buffer & core.event_mask;
  if (events == 0 && event) {
    core.waits_for = what;
    return {BusReply::Kind::blocked};
  }
  core.waits_for = Wait::nothing;
  if (clear) core.buffer &= ~events;
  return BusReply::done(events, event ? kEventLoadExtra : 0);
}

/// Accesses a register of the software events. There are three blocks of registers, each with one word per event. The
/// first block raises the event. The second block raises it and waits. The third block raises it, waits, and clears the
/// events that ended the wait.
BusReply ClusterEventUnit::software_event(unsigned core, std::uint32_t offset, const std::uint32_t* stored,
                                          bool event) {
  const auto number = offset % reg::kTriggerBytes / 4;
  const auto block = offset / reg::kTriggerBytes;
  if (number >= reg::kSoftwareEvents || block > 2) return {};
  if (block == 0) {
    if (stored == nullptr) return {};
    raise(*stored == 0 ? all() : *stored, number);
    return BusReply::done();
  }
  if (core == kNoCore || stored != nullptr) return {};
  auto& self = of_[core];
  if (self.waits_for != Wait::event) raise(self.software_targets, number);
  return wait(self, Wait::event, block == 2, event);
}

BusReply ClusterEventUnit::barrier_register(unsigned core, std::uint32_t offset, const std::uint32_t* stored,
                                            bool event) {
  if (offset / reg::kBarrierBytes >= kBarriers) return {};
  auto& barrier = barriers_[offset / reg::kBarrierBytes];
  const auto self = core == kNoCore ? 0 : 1U << core;
  switch (offset % reg::kBarrierBytes) {
    case reg::kBarrierTeam:
      if (stored == nullptr) return BusReply::done(barrier.team);
      barrier.team = *stored & all();
      open_if_complete(barrier);
      return BusReply::done();
    case reg::kBarrierTargets:
      if (stored == nullptr) return BusReply::done(barrier.targets);
      barrier.targets = *stored & all();
      return BusReply::done();
    case reg::kBarrierArrived:
      return load_only(barrier.arrived, stored);
    case reg::kBarrierSummary: {
      std::uint32_t waiting = 0;
      for (const auto& each : barriers_) waiting |= each.arrived;
      return load_only(waiting, stored);
    }
    case reg::kBarrierTrigger:
      if (stored == nullptr) return {};
      arrive(barrier, *stored & all());
      return BusReply::done();
    case reg::kBarrierTriggerSelf:
      if (self == 0) return {};
      arrive(barrier, self);
      return BusReply::done();
    default:
      break;
  }
  if (self == 0 || stored != nullptr) return {};
  if (of_[core].waits_for != Wait::barrier) arrive(barrier, self);
  return wait(of_[core], Wait::barrier, offset % reg::kBarrierBytes == reg::kBarrierTriggerWaitClear, event);
}

void ClusterEventUnit::arrive(Barrier& barrier, std::uint32_t cores) {
  barrier.arrived |= cores;
  open_if_complete(barrier);
}

void ClusterEventUnit::open_if_complete(Barrier& barrier) {
  if (barrier.arrived == 0 || barrier.arrived != barrier.team) return;
  barrier.arrived = 0;
  raise(barrier.targets, kBarrierEvent);
}

/// Accesses the mutex. A load locks it. A store unlocks it and passes a message to the next owner, which is the waiting
/// core with the lowest number.
BusReply ClusterEventUnit::mutex(unsigned core, const std::uint32_t* stored, bool event) {
  if (stored != nullptr) {
    mutex_message_ = *stored;
    for (unsigned other = 0; other < cores_; ++other) {
      if (of_[other].waits_for != Wait::mutex || of_[other].has_mutex) continue;
      of_[other].has_mutex = true;
      raise(1U << other, kMutexEvent);
      return BusReply::done();
    }
    mutex_locked_ = false;
    return BusReply::done();
  }
  auto& self = of_[core];
  if (!mutex_locked_ || self.has_mutex) {
    if (self.has_mutex) self.buffer &= ~(1U << kMutexEvent);
    self.has_mutex = false;
    self.waits_for = Wait::nothing;
    mutex_locked_ = true;
    return BusReply::done(mutex_message_, kEventLoadExtra);
  }
  if (!event) return {};
  self.waits_for = Wait::mutex;
  return {BusReply::Kind::blocked};
}

BusReply ClusterEventUnit::dispatch(unsigned core, std::uint32_t offset, const std::uint32_t* stored, bool event) {
  if (offset == reg::kDispatchTeam) {
    if (stored == nullptr) return BusReply::done(team_);
    team_ = *stored & all();
    return BusReply::done();
  }
  if (offset != reg::kDispatch) return {};
  if (stored != nullptr) {
    for (unsigned other = 0; other < cores_; ++other) {
      if ((team_ >> other & 1U) == 0) continue;
      auto& words = of_[other].dispatched;
      if (words.size() == kDispatchWords) words.erase(words.begin());
      words.push_back(*stored);
      if (of_[other].waits_for == Wait::dispatch) raise(1U << other, kDispatchEvent);
    }
    return BusReply::done();
  }
  auto& self = of_[core];
  if (self.dispatched.empty()) {
    if (!event) return {};
    self.waits_for = Wait::dispatch;
    return {BusReply::Kind::blocked};
  }
  const auto word = self.dispatched.front();
  self.dispatched.erase(self.dispatched.begin());
  if (self.waits_for == Wait::dispatch) self.buffer &= ~(1U << kDispatchEvent);
  self.waits_for = Wait::nothing;
  return BusReply::done(word, event ? kEventLoadExtra : 0);
}

void ClusterEventUnit::raise(std::uint32_t cores, unsigned event) {
  MEBOTS_ASSERT(event < kLines, "an event is a bit of a word");
  for (unsigned core = 0; core < cores_; ++core) {
    if ((cores >> core & 1U) == 0) continue;
    of_[core].buffer |= 1U << event;
    update(core);
  }
}

/// Must be called after the masks or the buffer of a core have changed. Marks the core as woken if an event ends its
/// wait, and marks its interrupt lines as changed.
void ClusterEventUnit::update(unsigned core) {
  const auto& self = of_[core];
  if (self.waits_for != Wait::nothing && (self.buffer & self.event_mask) != 0) woken_ |= 1U << core;
  line_changes_ |= 1U << core;
}

std::uint32_t ClusterEventUnit::take_woken() {
  const auto woken = woken_;
  woken_ = 0;
  return woken;
}

std::uint32_t ClusterEventUnit::take_line_changes() {
  const auto changes = line_changes_;
  line_changes_ = 0;
  return changes;
}

std::uint32_t ClusterEventUnit::lines(unsigned core) const {
  MEBOTS_ASSERT(core < cores_);
  return std::bit_floor(of_[core].buffer & of_[core].interrupt_mask);
}

void ClusterEventUnit::interrupt_taken(unsigned core, unsigned line) {
  MEBOTS_ASSERT(core < cores_ && line < kLines);
  of_[core].buffer &= ~(1U << line);
}

void ClusterEventUnit::visit(state::Visitor& v) {
  v("core", of_);
  v("barriers", barriers_);
  v("mutex_locked", mutex_locked_);
  v("mutex_message", mutex_message_);
  v("team", team_);
  v("woken", woken_);
  v("line_changes", line_changes_);
  for (const auto& core : of_) {
    if (core.dispatched.size() > kDispatchWords) {
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: too many words in the dispatcher");
    }
  }
}

}  // namespace mebots::soc::gap8_devices
