// SPDX-License-Identifier: Apache-2.0
#include "observe/power_trace.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace mebots::soc::observe {
namespace {

constexpr double kPicosecond = 1e-12;
constexpr std::size_t kCoreTrack = 0;
constexpr std::size_t kClockChannel = 0;
constexpr std::size_t kVoltageChannel = 1;
constexpr std::size_t kFirstPowerChannel = 2;

std::string_view core_state(const Soc& soc) {
  switch (soc.end()) {
    case End::none:
      return soc.hart().sleeping() ? "asleep" : "active";
    case End::powered_off:
      return "without power";
    default:
      return "ended";
  }
}

}  // namespace

PowerTrace::PowerTrace(const std::string& option, const std::string& path, const Soc& soc)
    : soc_(soc), span_start_(soc.now()) {
  std::vector<std::string> tracks{"core"};
  for (const auto& device : soc.devices().states()) tracks.emplace_back(device.name);
  std::vector<std::string> channels{"clock [Hz]", "voltage [V]"};
  for (const auto& component : soc.energy().components()) {
    channels.push_back(fmt::format("power.{} [W]", component.name));
  }
  for (const auto& slot : soc.devices()) {
    if (!slot.entry->states.empty()) channels.push_back(fmt::format("{} [W]", slot.entry->power_variable()));
  }
  states_.resize(tracks.size());
  writer_ = make_power_writer(option, path, std::move(tracks), std::move(channels));
  span_energies_j_ = energies(span_start_);
  note_states(span_start_);
}

std::vector<double> PowerTrace::energies(Picoseconds time) const {
  std::vector<double> found;
  for (const auto& component : soc_.power().energy_at(time).components()) found.push_back(component.energy_j);
  for (const auto& slot : soc_.devices()) {
    if (!slot.entry->states.empty()) found.push_back(slot.device->energy_j(time));
  }
  return found;
}

void PowerTrace::note_states(Picoseconds time) {
  const auto note = [&](std::size_t track, std::string_view state) {
    if (states_[track] == state) return;
    states_[track] = state;
    waiting_.push_back({time, track, state});
  };
  note(kCoreTrack, core_state(soc_));
  auto track = kCoreTrack;
  for (const auto& device : soc_.devices().states()) note(++track, device.state);
  span_clock_hz_ = soc_.power().clock_hz();
  span_voltage_v_ = soc_.power().voltage_v();
}

void PowerTrace::changed(Picoseconds time) {
  // After an earlier state was restored, the time may be before the last time in the file. Nothing is written until the
  // chip has reached the last time again.
  if (time < span_start_) return;
  if (time - span_start_ >= kShortest) close_span(time);
  note_states(time);
}

/// Writes the time span since the last call: mean values at the start of the span, and then the changes of state within
/// the span.
void PowerTrace::close_span(Picoseconds time) {
  const auto now_j = energies(time);
  writer_->value(span_start_, kClockChannel, span_clock_hz_);
  writer_->value(span_start_, kVoltageChannel, span_voltage_v_);
  const auto duration_s = static_cast<double>(time - span_start_) * kPicosecond;
  for (std::size_t i = 0; i < now_j.size(); ++i) {
    writer_->value(span_start_, kFirstPowerChannel + i, (now_j[i] - span_energies_j_[i]) / duration_s);
  }
  for (const auto& change : waiting_) writer_->state(change.time, change.track, change.state);
  waiting_.clear();
  span_start_ = time;
  span_energies_j_ = now_j;
}

void PowerTrace::restored() {
  if (soc_.now() >= span_start_) return;
  span_energies_j_ = energies(soc_.now());
}

void PowerTrace::finish() {
  const auto end = soc_.now();
  if (end > span_start_) close_span(end);
  note_states(std::max(end, span_start_));
  for (const auto& change : waiting_) writer_->state(change.time, change.track, change.state);
  writer_->finish(std::max(end, span_start_));
}

}  // namespace mebots::soc::observe
