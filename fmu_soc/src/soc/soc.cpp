// SPDX-License-Identifier: Apache-2.0
#include "soc/soc.hpp"

#include "mebots/error.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::soc {
namespace {

constexpr Picoseconds kWithoutEnd = kNever - 1;

}  // namespace

Device* Soc::device(std::string_view name) const {
  for (const auto& slot : devices_) {
    if (slot.entry->name == name) return slot.device;
  }
  return nullptr;
}

double* Soc::input(std::string_view variable) const {
  for (const auto& slot : devices_) {
    if (auto* found = slot.device->input(variable)) return found;
  }
  return nullptr;
}

const double* Soc::output(std::string_view variable) const {
  for (const auto& slot : devices_) {
    if (const auto* found = slot.device->output(variable)) return found;
  }
  return nullptr;
}

void Soc::begin_step() {
  if (end_ == End::powered_off) return;
  for (const auto& slot : devices_) slot.device->begin_step(now_);
}

bool Soc::poke(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (!memory_.write(address, bytes)) return false;
  memory_.changed(address, static_cast<std::uint32_t>(bytes.size()));
  return true;
}

void Soc::advance(std::int64_t time_ns) {
  alone_ = false;
  go_on(time_ns * kPsPerNs, kNoLimit);
  decisions_.published(now_);
}

void Soc::run_cycles(std::uint64_t cycle_limit) {
  alone_ = true;
  go_on(kWithoutEnd, cycle_limit);
}

void Soc::go_on(Picoseconds until, std::uint64_t cycle_limit) {
  touch_devices();  // from outside
  tell(now_);
  for (;;) {
    const auto event = next_event();
    const auto cluster = cluster_next();
    if (cluster_ && cluster_->longest_cycles() >= cycle_limit) break;
    if (until == kWithoutEnd && !running()) break;  // timers of an ended program tick for ever
    if (asleep_) {
      const auto first = std::min(event, cluster);
      if (first > until || first == kNever) break;
      if (event <= cluster) {
        advance_devices(event);
        wake_if_interrupted(event);
      } else {
        // With a listener, one quantum after the other, so that it hears of each.
        advance_cluster(event, listener_ != nullptr ? cluster : until, cycle_limit);
      }
      tell(first);
      continue;
    }
    // The fabric controller goes ahead of the cluster, but not far.
    const auto lead = cluster == kNever ? kNever : cluster_->later(cluster, kLead);
    const auto stop_at = std::min(event, lead);
    const bool stop_comes = stop_at <= until;
    const auto limit = stop_comes ? clock_.first_at(stop_at) : clock_.first_after(until);
    const auto stop = hart_.run(std::min(limit, cycle_limit));
    if (stop != Stop::limit) {
      handle(stop);
      tell(core_time());
      continue;
    }
    if (hart_.counters().cycles < limit) {
      now_ = core_time();  // the cycle limit
      tell(now_);
      return;
    }
    if (!stop_comes) break;
    if (event <= lead) {
      advance_devices(event);
    } else {
      advance_cluster(lead, lead);
    }
    tell(core_time());
  }
  now_ = until == kWithoutEnd ? reached() : until;
  tell(now_);
}

/// How far a run without end has come: to where the core stands that ended it, or else the last of all.
Picoseconds Soc::reached() const {
  if (!running()) return std::max(now_, end_time_);
  const auto of_cluster = cluster_ ? cluster_->reached() : 0;
  return std::max({now_, asleep_ ? asleep_since_ : core_time(), of_cluster});
}

Picoseconds Soc::cluster_next() const {
  return cluster_ && running() ? cluster_->next() : kNever;
}

/// The cluster runs until it has caught up, or, while the fabric controller sleeps, for quanta that begin up to `last`
/// or until something may wake that one.
void Soc::advance_cluster(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit) {
  do {
    cluster_->advance(until, last, cycle_limit);
    if (event_unit_ != nullptr && !asked_.power) {  // a core has used the devices of GAP8's SoC
      apply_power_settings(cluster_->fabric_event_time());
      if (signals_.exit_code && running()) {
        end_by_program(cluster_->fabric_event_time());
        return;
      }
    }
    update_lines();
    if (cluster_->take_fabric_wake()) hart_.wake();
    if (cluster_->faulted_core() >= 0) {
      finish(End::faulted, cluster_->stop_time());
      if (listeners_.faults) listeners_.faults(fault_text());
    } else if (cluster_->stopped()) {
      finish(cluster_->core_stopped_by_observer() >= 0 ? End::stopped : End::host, cluster_->stop_time());
    } else if (asleep_) {
      wake_if_interrupted(cluster_->fabric_event_time());
      return;
    }
  } while (cluster_next() < until);
}

void Soc::end_by_program(Picoseconds time) {
  finish(End::exited, time);
  if (gave_up() && listeners_.faults) listeners_.faults(fault_text());
}

void Soc::handle(Stop stop) {
  touch_devices();
  switch (stop) {
    case Stop::device:
      apply_power_settings(core_time());
      update_lines();
      if (host_exit_ || signals_.exit_code || (power_manager_ && power_manager_->exited())) {
        end_by_program(core_time());
      }
      break;
    case Stop::sleeping:
      asleep_ = true;
      asleep_since_ = core_time();
      retained_ = power_manager_ && power_manager_->settings().retention != 0;
      break;
    case Stop::watch:
      if (const auto command = command_to_host(); !is_half_stored(command) && serve_command(command)) {
        finish(End::host, core_time());
      }
      break;
    case Stop::fault:
      finish(End::faulted, core_time());
      if (listeners_.faults) listeners_.faults(fault_text());
      break;
    case Stop::turn:
      advance_cluster(core_time(), core_time());
      break;
    case Stop::observer:
      finish(End::stopped, core_time());
      break;
    case Stop::limit:
      break;
  }
}

/// At `time` by the core that ended the program. A fabric controller that is awake may be ahead of it; one that slept
/// sleeps on.
void Soc::finish(End why, Picoseconds time) {
  end_ = why;
  end_time_ = std::max(core_time(), time);
  if (!asleep_) asleep_since_ = end_time_;
  asleep_ = true;
  for (const auto& slot : devices_) slot.device->program_ended();
  touch_devices();
}

void Soc::power_off() {
  if (end_ == End::powered_off) return;
  if (asleep_ && now_ > asleep_since_) slept_ += now_ - asleep_since_;
  retention_ = retention_time(now_);
  retained_ = false;
  end_ = End::powered_off;
  end_time_ = now_;
  asleep_ = true;
  asleep_since_ = kNever;
  for (const auto& slot : devices_) slot.device->program_ended();
  touch_devices();
}

/// When a device next does something by itself.
Picoseconds Soc::next_event() {
  if (end_ == End::powered_off) return kNever;
  if (!asked_.next_event) {
    next_event_ = kNever;
    for (const auto& slot : devices_) next_event_ = std::min(next_event_, slot.device->next_event());
    asked_.next_event = true;
  }
  return next_event_;
}

void Soc::advance_devices(Picoseconds time) {
  for (const auto& slot : devices_) slot.device->advance(time);
  touch_devices();
  update_lines();
}

void Soc::update_lines() {
  const bool asked = std::exchange(asked_.lines, true);
  if (event_unit_ != nullptr) {
    if (asked) return;
    for (const auto& slot : slots_) {
      if (slot.interrupt >= 0 && slot.device->interrupt()) event_unit_->raise(static_cast<unsigned>(slot.interrupt));
    }
    hart_.set_interrupts(event_unit_->lines());
    if (event_unit_->take_wake()) hart_.wake();
    return;
  }
  if (!asked) {
    for (const auto& slot : slots_) {
      if (slot.interrupt >= 0) hart_.set_interrupt(static_cast<unsigned>(slot.interrupt), slot.device->interrupt());
    }
  }
  if (cluster_ && cluster_interrupt_ >= 0) {
    hart_.set_interrupt(static_cast<unsigned>(cluster_interrupt_), cluster_->interrupt());
  }
}

/// What the firmware asks of clocks, voltage and cluster; null when the board has nothing to ask.
const PowerSettings* Soc::power_settings() const {
  if (power_manager_ != nullptr) return &power_manager_->settings();
  return signals_.power ? &*signals_.power : nullptr;
}

void Soc::interrupt_taken(unsigned line) {
  if (event_unit_ == nullptr) return;
  touch_devices();
  event_unit_->acknowledge(line);
  hart_.set_interrupts(event_unit_->lines());
}

/// At `time` a core has asked for them. The cluster's clock changes then: no core of it stands before. All else changes
/// behind the fabric controller's last instruction, which may be further on and has had the old settings.
void Soc::apply_power_settings(Picoseconds time) {
  asked_.power = true;
  const auto* settings = power_settings();
  if (settings == nullptr) return;
  const auto& wanted = *settings;
  const bool changed = wanted.clock_hz != clock_.hz() || wanted.voltage_mv != voltage_mv_ ||
                       (cluster_ && wanted.cluster_clock_hz != cluster_->clock_hz());
  const auto now = std::max(time, core_time());
  const auto before = changed ? activity_at(now) : Activity{};
  if (wanted.clock_hz != clock_.hz()) clock_.change(wanted.clock_hz, hart_.counters().cycles);
  if (cluster_ && wanted.cluster_clock_hz != cluster_->clock_hz()) cluster_->set_clock(time, wanted.cluster_clock_hz);
  voltage_mv_ = wanted.voltage_mv;
  if (changed) {
    meter_.change(power_state(), before);
    set_ways();
    asked_.next_event = false;  // of timers
  }
  if (!cluster_) return;
  if ((wanted.cluster_on != 0) == cluster_->powered()) return;
  if (wanted.cluster_on != 0) {
    cluster_->power_on(now, wanted.cluster_boot);
  } else {
    cluster_->power_off(now);
  }
  connect_memories();
}

void Soc::wake_if_interrupted(Picoseconds time) {
  if (end_ != End::none || (hart_.sleeping() && !hart_.wakes())) return;
  auto wake = std::max(time, asleep_since_);
  if (retained_) {
    retention_ += wake - asleep_since_;
    retained_ = false;
    power_manager_->woken();
    if (instruction_cache_) instruction_cache_->flush();  // the memories are kept, the cache is not
    wake += std::llround(chip_.wake_up_s * kPsPerS);
  }
  clock_.wake(hart_.counters().cycles, wake);
  slept_ += core_time() - asleep_since_;
  asleep_ = false;
}

void Soc::observe(unsigned number, Observer* observer) {
  if (number == kFabricControllerHart) {
    hart_.observe(observer);
  } else {
    cluster_->observe(core_of_hart(number), observer);
  }
}

void Soc::visit(state::Visitor& v) {
  v("memory", memory_);
  if (instruction_cache_) v("instruction_cache", *instruction_cache_);
  v("hart", hart_);
  if (cluster_) v("cluster", *cluster_);
  for (const auto& slot : devices_) v(slot.entry->name, *slot.device);
  v("signals", signals_);
  v("meter", meter_);
  v("clock", clock_);
  v("voltage_mv", voltage_mv_);
  v("now", now_);
  v("end", end_);
  v("end_time", end_time_);
  v("ended_by", ended_by_);
  v("asleep", asleep_);
  v("asleep_since", asleep_since_);
  v("slept", slept_);
  v("retained", retained_);
  v("retention", retention_);
  v("state_times", state_times_);
  v("decisions", decisions_);
  v("controller_work", controller_work_);
  v("work_noted", work_noted_);
  v("cluster_work_noted", cluster_work_noted_);
  v("awake_noted", awake_noted_);
  if (!v.restores()) return;
  if (ended_by_ < kFabricControllerCore || ended_by_ >= (cluster_ ? static_cast<int>(cluster_->cores()) : 0)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: a core that there is not ended the program");
  }
  connect_memories();
  set_ways();
}

}  // namespace mebots::soc
