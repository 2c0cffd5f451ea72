// SPDX-License-Identifier: Apache-2.0
//
// What the chip has done up to a point in time: states, sleep, work, accesses, and the energy of it all.
#include "mebots/soc/fixed_point.hpp"
#include "soc/soc.hpp"

#include <algorithm>

namespace mebots::soc {

Picoseconds Soc::sleep_time() const {
  return slept_at(now_);
}

bool Soc::waits_for_picture() const {
  return std::ranges::any_of(devices_, [](const auto& slot) { return slot.device->takes_picture(); });
}

ChipState Soc::chip_state() const {
  if (end_ == End::powered_off) return ChipState::off;
  if (cluster_ && cluster_->powered()) return ChipState::cluster;
  if (!asleep_) return ChipState::controller;
  return waits_for_picture() ? ChipState::waiting : ChipState::asleep;
}

/// Something may have changed at `time`, or later, when it woke the core.
void Soc::tell(Picoseconds time) {
  const auto reached = asleep_ ? time : std::max(time, core_time());
  state_times_.pass(reached, chip_state());
  note_work(reached);
  if (listener_ != nullptr) listener_->changed(time);
}

/// The fabric controller has been awake, or has slept, up to `time`.
void Soc::note_work(Picoseconds time) {
  // Only where it changes: what the cluster is known to have done up to `time` depends on when it is asked.
  if (awake_noted_ == !asleep_) return;
  if (time > work_noted_) {
    controller_work_ = controller_work(time);
    work_noted_ = time;
    cluster_work_noted_ = cluster_ ? cluster_->busy_time(time) : 0;
  }
  awake_noted_ = !asleep_;
}

Picoseconds Soc::controller_work(Picoseconds now) const {
  const auto span = now - work_noted_;
  if (!awake_noted_ || span <= 0) return controller_work_;
  const auto of_cluster = cluster_ ? cluster_->busy_time(now) - cluster_work_noted_ : 0;
  return controller_work_ + span - std::clamp<Picoseconds>(of_cluster, 0, span);
}

Picoseconds Soc::slept_at(Picoseconds now) const {
  return slept_ + (asleep_ && now > asleep_since_ ? now - asleep_since_ : 0);
}

CoreWork Soc::work_at(Picoseconds now) const {
  CoreWork work;
  work.controller = controller_work(now);
  work.controller_awake = now - slept_at(now);
  if (!cluster_) return work;
  work.cluster = cluster_->busy_time(now);
  work.cluster_hz = cluster_->clock_hz();
  for (unsigned core = 0; core < cluster_->cores(); ++core) {
    work.core_cycles[core] = cluster_->hart(core).counters().cycles;
  }
  return work;
}

Picoseconds Soc::retention_time(Picoseconds now) const {
  return retention_ + (retained_ && now > asleep_since_ ? now - asleep_since_ : 0);
}

PowerState Soc::power_state() const {
  return {temperature_c_, voltage_mv_ / kMilli, static_cast<double>(clock_.hz()),
          cluster_ ? static_cast<double>(cluster_->clock_hz()) : 0.0};
}

/// What the chip did up to `now`. Of the fabric controller's accesses, the first memory is L2; those to L1 count as its
/// own memory's, over the interconnect. Of a cluster core's, the first is L1, all others are L2.
Activity Soc::activity_at(Picoseconds now) const {
  const auto& counters = hart_.counters();
  Activity activity;
  activity.fc_instruction_fj = counters.instruction_fj;
  activity.fc_memory_accesses = counters.far_accesses;
  activity.l2_accesses = counters.near_accesses();
  activity.far_words = counters.device_accesses;
  if (instruction_cache_) activity.l2_accesses += instruction_cache_->refills() * instruction_cache_->words_per_line();
  activity.powered = now;
  activity.fc_asleep = slept_at(now);
  activity.retained = retention_time(now);
  if (!cluster_) return activity;
  const auto cluster = cluster_->counters();
  const auto& dma = cluster_->dma().counts();
  const auto dma_words = dma.bytes / 4;
  activity.cluster_instruction_fj = cluster.instruction_fj;
  activity.cluster_cycles = cluster.cycles;
  activity.l1_accesses = cluster.near_accesses() + dma_words;
  activity.l2_accesses += cluster.far_accesses + dma_words;
  activity.far_words += cluster.far_accesses + dma_words;
  activity.dma_cycles = dma.busy_cycles;
  if (const auto* cache = cluster_->instruction_cache(); cache != nullptr) {
    const auto words = cache->refills() * cache->words_per_line();
    activity.l2_accesses += words;
    activity.far_words += words;
  }
  activity.cluster_powered = cluster_->powered_time(now);
  for (unsigned core = 0; core < cluster_->cores(); ++core) activity.of_cores[core] = core_activity(core);
  return activity;
}

CoreActivity Soc::core_activity(unsigned core) const {
  const auto& counters = cluster_->hart(core).counters();
  return {counters.instruction_fj, counters.cycles, counters.near_accesses(), counters.far_accesses};
}

std::uint64_t Soc::instructions() const {
  return hart_.counters().instructions + (cluster_ ? cluster_->counters().instructions : 0);
}

EnergyLedger Soc::energy_at(Picoseconds time) const {
  const auto until = end_ == End::powered_off ? std::min(time, end_time_) : time;
  // An instruction that begins before a point ends behind it. When it changes clock or voltage, what was before is
  // settled up to its end: less than that cannot be told any more.
  return meter_.at(activity_at(std::max(until, meter_.settled_until())));
}

CountEnergy Soc::energy_per_count(unsigned number) const {
  if (number != kFabricControllerHart) return meter_.per_count_of_core();
  return meter_.per_count_of_fabric_controller(cluster_ && cluster_->powered());
}

std::vector<Soc::DeviceState> Soc::device_states() const {
  std::vector<DeviceState> states;
  for (const auto& slot : devices_) {
    if (const auto state = slot.device->state_name(); !state.empty()) states.push_back({slot.entry->name, state});
  }
  return states;
}

}  // namespace mebots::soc
