// SPDX-License-Identifier: Apache-2.0
#include "devices/described_device.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::soc {
namespace {

constexpr std::string_view kStatus = "status";

}  // namespace

DescribedDevice::DescribedDevice(const BoardDevice& description)
    : description_(description),
      values_(description.registers.size()),
      spent_(description.states.size()),
      state_(state_index(description.initial_state)) {
  for (const auto& variable : description_.sensed) sensed_.push_back(variable.start);
  MEBOTS_ASSERT(state_ < description_.states.size(), "the board file names a state of the device");
}

std::size_t DescribedDevice::register_at(std::uint32_t offset) const {
  const auto& registers = description_.registers;
  const auto found =
      std::find_if(registers.begin(), registers.end(), [&](const auto& r) { return r.offset == offset; });
  return static_cast<std::size_t>(found - registers.begin());
}

std::size_t DescribedDevice::state_index(std::string_view name) const {
  const auto& states = description_.states;
  const auto found = std::find_if(states.begin(), states.end(), [&](const auto& s) { return s.name == name; });
  return static_cast<std::size_t>(found - states.begin());
}

bool DescribedDevice::set_sensed(std::string_view variable, double value) {
  for (std::size_t i = 0; i < sensed_.size(); ++i) {
    if (description_.sensed[i].name != variable) continue;
    sensed_[i] = value;
    return true;
  }
  return false;
}

std::optional<double> DescribedDevice::sent(std::string_view variable) const {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& reg = description_.registers[i];
    if (reg.sends == variable) return from_register(values_[i], reg.units_per_si);
  }
  return std::nullopt;
}

bool DescribedDevice::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  const auto index = register_at(offset);
  if (index == values_.size()) return false;
  const auto& reg = description_.registers[index];
  if (reg.access == "w") return false;
  value = reg.shows == kStatus ? status_ : values_[index];
  return true;
}

bool DescribedDevice::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  const auto index = register_at(offset);
  if (index == values_.size()) return false;
  const auto& reg = description_.registers[index];
  if (reg.access == "r") return false;
  if (reg.shows == kStatus) {
    status_ &= ~(value & (kReady | kRefused));
    return true;
  }
  bool takes_opcodes = false;
  const BoardOpcode* found = nullptr;
  for (const auto& opcode : description_.opcodes) {
    if (opcode.register_name != reg.name) continue;
    takes_opcodes = true;
    if (opcode.value == value) found = &opcode;
  }
  if (takes_opcodes) {
    obey(found, now);
  } else {
    values_[index] = value;
  }
  return true;
}

void DescribedDevice::obey(const BoardOpcode* opcode, Picoseconds now) {
  const auto state = opcode == nullptr ? description_.states.size() : state_index(opcode->state);
  if (opcode == nullptr || (done_at_ != kNever && description_.states[state].delay_s > 0)) {
    status_ |= kRefused;
    return;
  }
  enter(state, now);
}

void DescribedDevice::enter(std::size_t state, Picoseconds now) {
  MEBOTS_ASSERT(state < description_.states.size() && state_ < spent_.size());
  MEBOTS_ASSERT(now >= since_, "calls come in the order of time");
  spent_[state_] += now - since_;
  since_ = now;
  state_ = state;
  const auto delay_s = description_.states[state].delay_s;
  done_at_ = delay_s > 0 ? now + std::llround(delay_s * kPsPerS) : kNever;
  status_ = delay_s > 0 ? status_ | kBusy : status_ & ~kBusy;
}

void DescribedDevice::advance(Picoseconds now) {
  if (now < done_at_) return;
  measure();
  status_ |= kReady;
  enter(state_index(description_.states[state_].then), done_at_);
}

void DescribedDevice::measure() {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& reg = description_.registers[i];
    for (std::size_t k = 0; k < sensed_.size(); ++k) {
      if (description_.sensed[k].name == reg.shows) values_[i] = to_register(sensed_[k], reg.units_per_si);
    }
  }
}

double DescribedDevice::energy_j(Picoseconds now) const {
  double charge_as = 0;
  for (std::size_t i = 0; i < spent_.size(); ++i) {
    const auto time = spent_[i] + (i == state_ ? now - since_ : 0);
    charge_as += description_.states[i].current_a * static_cast<double>(time) / kPsPerS;
  }
  return charge_as * description_.supply_voltage_v;
}

void DescribedDevice::visit(state::Visitor& v) {
  v("sensed", std::span(sensed_));
  v("values", std::span(values_));
  v("spent", std::span(spent_));
  v("state", state_);
  if (state_ >= description_.states.size())
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: device " + description_.name + " is in no state");
  v("status", status_);
  v("since", since_);
  v("done_at", done_at_);
}

}  // namespace mebots::soc
