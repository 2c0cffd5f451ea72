// SPDX-License-Identifier: Apache-2.0
#include "soc/soc.hpp"

#include "mebots/error.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::soc {
namespace {

std::uint32_t checked_clock(const Chip& chip, const Settings& settings) {
  const auto clock_hz = static_cast<std::uint32_t>(std::llround(settings.clock_hz));
  const auto voltage_mv = static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli));
  if (!chip.allows(clock_hz, voltage_mv)) {
    throw Error(fmt::format(
        "core.clock {} Hz at core.supply_voltage {} V is outside the chip's limits: {} to {} V in steps of "
        "{} mV, and {} to {:.0f} Hz at {} V",
        settings.clock_hz, settings.voltage_v, chip.lowest_voltage_v, chip.highest_voltage_v, chip.voltage_step_mv,
        chip.minimum_clock_hz, chip.highest_clock_hz(settings.voltage_v), settings.voltage_v));
  }
  return clock_hz;
}

/// Returns the board, in which registers that show a parameter of the chip contain the value of this parameter.
BoardDescription with_settings(BoardDescription board, const Settings& settings) {
  for (auto& device : board.devices) {
    for (auto& reg : device.registers) {
      const auto shown = std::ranges::find(kChipSettings, std::string_view(reg.shows), &ChipSetting::variable);
      if (shown != kChipSettings.end()) reg.reset = to_register(settings.*shown->value, reg.units_per_si);
    }
  }
  return board;
}

/// Throws Error if the program needs the extension F and the core lacks it. Otherwise the program would stop at its
/// first floating-point instruction, perhaps late in a run.
void require_float_registers(const BoardDescription& board, const Elf& program) {
  if (!program.uses_float_registers() || board.isa.has(Extension::f)) return;
  throw Error(fmt::format(
      "{}: compiled for floating-point registers (-mabi=ilp32f), which the core of board {} lacks: compile with "
      "-mabi=ilp32, or give the core F, as --core rv32imafc or the board's key isa does",
      program.origin(), board.name));
}

}  // namespace

Soc::Soc(const BoardDescription& board, const Chip& chip, const Settings& settings, const Elf& program,
         Listeners listeners)
    : listeners_(std::move(listeners)),
      program_(program),
      board_(with_settings(board, settings)),
      devices_(board_, settings.library_folders),
      bus_(hardware_, timeline_, devices_, program_host_, listeners_.faults),
      hardware_(board_, chip, settings, bus_),
      timeline_(hardware_.controller()),
      program_host_(hardware_, program_),
      power_(hardware_, timeline_, settings),
      work_(hardware_, timeline_, devices_, board.decisions_end_with),
      services_({hardware_, timeline_, devices_, power_, work_, program_host_, listeners_}, settings) {
  require_float_registers(board_, program_);
  timeline_.clock().reset(checked_clock(chip, settings));
  hardware_.add_cluster(settings, services_);
  if (auto* cluster = hardware_.cluster()) {
    devices_.signals().cluster_cores = cluster->cores();
    if (std::ranges::find(board_.devices, kGap8ClusterKind, &BoardDevice::kind) != board_.devices.end()) {
      cluster->set_outside(
          [this](const ClusterAccess& access, Picoseconds now) { return bus_.from_cluster(access, now); });
    }
    cluster->set_watcher([this](std::uint32_t /*address*/) { return program_host_.serve_stored(); });
  }
  devices_.make(services_);
  hardware_.connect_memories();
  hardware_.set_latencies(timeline_.clock().hz());
  hardware_.load_program(program_, devices_);
  hart().reset(program_.entry());
  apply_power_settings(core_time());  // GAP8's own devices set clocks and voltage at the start
}

void Soc::begin_step() {
  if (end() != End::powered_off) devices_.begin_step(now());
}

void Soc::advance(std::int64_t time_ns) {
  work_.set_alone(false);
  run(time_ns * kPsPerNs, kNoLimit, false);
  work_.publish(now());
}

void Soc::run_cycles(std::uint64_t cycle_limit, Picoseconds until) {
  work_.set_alone(true);
  run(until, cycle_limit, true);
}

bool Soc::sleeps_for_good() {
  return running() && timeline_.asleep() && next_event() == kNever && cluster_next() == kNever;
}

void Soc::run(Picoseconds until, std::uint64_t cycle_limit, bool is_alone) {
  devices_.touch();  // the caller may have accessed a device
  notify(now());
  bool at_time = !is_alone;
  for (;;) {
    const auto event = next_event();
    const auto cluster = cluster_next();
    if (hardware_.cluster() != nullptr && hardware_.cluster()->longest_cycles() >= cycle_limit) break;
    if (is_alone && !running()) break;  // timers of an ended program never stop
    if (timeline_.asleep()) {
      const auto first = std::min(event, cluster);
      at_time = at_time || (first > until && first != kNever);
      if (first > until || first == kNever) break;
      if (event <= cluster) {
        advance_devices(event);
        wake_if_interrupted(event);
      } else {
        // A listener must be called after each quantum.
        advance_cluster(event, listener_ != nullptr ? cluster : until, cycle_limit);
      }
      notify(first);
      continue;
    }
    const auto lead = cluster == kNever ? kNever : hardware_.cluster()->later(cluster, kLead);
    const auto stop_at = std::min(event, lead);
    const bool stop_comes = stop_at <= until;
    const auto limit = stop_comes ? timeline_.clock().first_at(stop_at) : timeline_.clock().first_after(until);
    const auto stop = hart().run(std::min(limit, cycle_limit));
    if (stop != Stop::limit) {
      handle(stop);
      notify(core_time());
      continue;
    }
    if (hart().counters().cycles < limit) {
      timeline_.reach(core_time());  // the cycle limit was reached
      notify(now());
      return;
    }
    if (!stop_comes) {
      at_time = true;
      break;
    }
    if (event <= lead) {
      advance_devices(event);
    } else {
      advance_cluster(lead, lead);
    }
    notify(core_time());
  }
  timeline_.reach(at_time ? until : timeline_.reached(hardware_.cluster()));
  notify(now());
}

/// Runs the cluster to `until`. While the fabric controller sleeps, runs all quanta that begin at or before `last`, but
/// stops at an event that may wake the fabric controller.
void Soc::advance_cluster(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit) {
  auto* cluster = hardware_.cluster();
  do {
    cluster->advance(until, last, cycle_limit);
    // A cluster core may have accessed a device of GAP8 that changes clocks or voltage, or that ends the program.
    if (devices_.event_unit() != nullptr && !devices_.power_is_applied()) {
      apply_power_settings(cluster->fabric_event_time());
      if (devices_.signals().exit_code && running()) {
        end_by_program(cluster->fabric_event_time());
        return;
      }
    }
    update_lines();
    if (cluster->take_fabric_wake()) hart().wake();
    if (cluster->faulted_core() >= 0) {
      finish(End::faulted, cluster->stop_time());
      report_fault();
    } else if (cluster->stopped()) {
      finish(cluster->core_stopped_by_observer() >= 0 ? End::stopped : End::host, cluster->stop_time());
    } else if (timeline_.asleep()) {
      wake_if_interrupted(cluster->fabric_event_time());
      return;
    }
  } while (cluster_next() < until);
}

void Soc::end_by_program(Picoseconds time) {
  finish(End::exited, time);
  if (gave_up()) report_fault();
}

void Soc::handle(Stop stop) {
  devices_.touch();
  switch (stop) {
    case Stop::device:
      apply_power_settings(core_time());
      update_lines();
      if (program_host_.exit_code() || devices_.have_exited()) {
        end_by_program(core_time());
      }
      break;
    case Stop::sleeping:
      timeline_.sleep(devices_.power_manager() != nullptr && devices_.power_manager()->settings().retention != 0);
      break;
    case Stop::watch:
      if (const auto command = program_host_.command();
          !program_host_.is_half_stored(command) && program_host_.serve_command(command)) {
        finish(End::host, core_time());
      }
      break;
    case Stop::fault:
      finish(End::faulted, core_time());
      report_fault();
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

void Soc::finish(End why, Picoseconds time) {
  timeline_.finish(why, time);
  devices_.end_program();
}

void Soc::power_off() {
  if (end() == End::powered_off) return;
  timeline_.power_off();
  devices_.end_program();
}

void Soc::report_fault() const {
  if (listeners_.faults) listeners_.faults(fault_text());
}

/// Reports to the WorkAccount and to the listener that the state of the chip may have changed at `time`.
void Soc::notify(Picoseconds time) {
  work_.pass(time);
  if (listener_ != nullptr) listener_->changed(time);
}

Picoseconds Soc::next_event() {
  return end() == End::powered_off ? kNever : devices_.next_event();
}

void Soc::advance_devices(Picoseconds time) {
  devices_.advance(time);
  update_lines();
}

void Soc::update_lines() {
  devices_.update_lines(hart(), hardware_.cluster(), hardware_.cluster_interrupt());
}

/// Applies the settings that a core has requested at `time`. The cluster's clock changes at that time, because all
/// cluster cores have reached it. All other settings change after the fabric controller's last instruction, which may
/// be later than `time`.
void Soc::apply_power_settings(Picoseconds time) {
  devices_.set_power_applied();
  const auto* settings = devices_.power_settings();
  if (settings == nullptr) return;
  const auto& wanted = *settings;
  auto& clock = timeline_.clock();
  auto* cluster = hardware_.cluster();
  const bool changes_cluster = cluster != nullptr && wanted.cluster_clock_hz != cluster->clock_hz();
  const bool changed = wanted.clock_hz != clock.hz() || wanted.voltage_mv != power_.voltage_mv() || changes_cluster;
  const auto now = std::max(time, core_time());
  const auto before = changed ? power_.activity_at(now) : Activity{};
  if (wanted.clock_hz != clock.hz()) clock.change(wanted.clock_hz, hart().counters().cycles);
  if (changes_cluster) cluster->set_clock(time, wanted.cluster_clock_hz);
  power_.set_voltage(wanted.voltage_mv);
  if (changed) {
    power_.change(before);
    hardware_.set_latencies(clock.hz());
    devices_.forget_next_event();  // the timers' next events have changed
  }
  if (cluster == nullptr || (wanted.cluster_on != 0) == cluster->powered()) return;
  if (wanted.cluster_on != 0) {
    cluster->power_on(now, wanted.cluster_boot);
  } else {
    cluster->power_off(now);
  }
  hardware_.connect_memories();
}

void Soc::wake_if_interrupted(Picoseconds time) {
  if (!running() || (hart().sleeping() && !hart().wakes())) return;
  auto wake = std::max(time, timeline_.asleep_since());
  if (timeline_.retained()) {
    timeline_.end_retention(wake);
    devices_.power_manager()->woken();
    // In retention sleep, the memories keep their contents, but the cache does not.
    if (auto* cache = hardware_.instruction_cache()) cache->flush();
    wake += std::llround(hardware_.chip().wake_up_s * kPsPerS);
  }
  timeline_.wake(wake);
}

Picoseconds Soc::core_time(unsigned number) const {
  return number == kFabricControllerHart ? timeline_.core_time() : cluster()->core_time(core_of_hart(number));
}

Picoseconds Soc::core_time_at(unsigned number, std::uint64_t cycle) const {
  if (number == kFabricControllerHart) return timeline_.clock().time_of(cycle);
  return cluster()->core_time_at(core_of_hart(number), cycle);
}

std::uint64_t Soc::instructions() const {
  return hart().counters().instructions + (cluster() != nullptr ? cluster()->counters().instructions : 0);
}

std::int32_t Soc::exit_code() const {
  if (const auto code = program_host_.exit_code()) return static_cast<std::int32_t>(*code);
  return devices_.exit_code();
}

bool Soc::faulted() const {
  return hart().fault().happened || (cluster() != nullptr && cluster()->faulted_core() >= 0) || gave_up().has_value();
}

void Soc::observe(unsigned number, Observer* observer) {
  if (number == kFabricControllerHart) {
    hart().observe(observer);
  } else {
    hardware_.cluster()->observe(core_of_hart(number), observer);
  }
}

void Soc::visit(state::Visitor& v) {
  hardware_.visit(v);
  devices_.visit(v);
  power_.visit(v);
  timeline_.visit(v);
  work_.visit(v);
  if (!v.restores()) return;
  timeline_.check(cluster());
  hardware_.connect_memories();
  hardware_.set_latencies(timeline_.clock().hz());
}

}  // namespace mebots::soc
