// SPDX-License-Identifier: Apache-2.0
#include "soc/work_account.hpp"

#include <algorithm>

namespace mebots::soc {

ChipState WorkAccount::chip_state() const {
  if (timeline_.end() == End::powered_off) return ChipState::off;
  if (hardware_.cluster() != nullptr && hardware_.cluster()->powered()) return ChipState::cluster;
  if (!timeline_.asleep()) return ChipState::controller;
  return devices_.wait_for_picture() ? ChipState::waiting : ChipState::asleep;
}

void WorkAccount::pass(Picoseconds time) {
  const auto reached = timeline_.asleep() ? time : std::max(time, timeline_.core_time());
  state_times_.pass(reached, chip_state());
  note(reached);
}

/// Adds the fabric controller's work up to `time`, at which it fell asleep or woke.
void WorkAccount::note(Picoseconds time) {
  // The times of work are only added up when the controller falls asleep or wakes. At other times, the cluster may not
  // have reached `time`. The result would then depend on when this function is called.
  if (awake_noted_ == !timeline_.asleep()) return;
  if (time > work_noted_) {
    controller_work_ = controller_work(time);
    work_noted_ = time;
    cluster_work_noted_ = hardware_.cluster() != nullptr ? hardware_.cluster()->busy_time(time) : 0;
  }
  awake_noted_ = !timeline_.asleep();
}

Picoseconds WorkAccount::controller_work(Picoseconds now) const {
  const auto span = now - work_noted_;
  if (!awake_noted_ || span <= 0) return controller_work_;
  const auto of_cluster =
      hardware_.cluster() != nullptr ? hardware_.cluster()->busy_time(now) - cluster_work_noted_ : 0;
  return controller_work_ + span - std::clamp<Picoseconds>(of_cluster, 0, span);
}

CoreWork WorkAccount::work_at(Picoseconds now) const {
  CoreWork work;
  work.controller = controller_work(now);
  work.controller_awake = now - timeline_.slept_at(now);
  const auto* cluster = hardware_.cluster();
  if (cluster == nullptr) return work;
  work.cluster = cluster->busy_time(now);
  work.cluster_hz = cluster->clock_hz();
  for (unsigned core = 0; core < cluster->cores(); ++core) {
    work.core_cycles[core] = cluster->hart(core).counters().cycles;
  }
  return work;
}

void WorkAccount::setpoints_sent(std::string_view sender, Picoseconds now) {
  decisions_.sent(sender, now, work_at(now));
  if (alone_) decisions_.published(now);
}

void WorkAccount::visit(state::Visitor& v) {
  v("state_times", state_times_);
  v("decisions", decisions_);
  v("controller_work", controller_work_);
  v("work_noted", work_noted_);
  v("cluster_work_noted", cluster_work_noted_);
  v("awake_noted", awake_noted_);
}

}  // namespace mebots::soc
