// SPDX-License-Identifier: Apache-2.0
#include "devices/core/described_device.hpp"

#include "devices/core/kinds.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::soc {
namespace {

constexpr std::string_view kStatus = "status";

/// Returns the position of a variable among the entry's inputs, or among its outputs.
std::size_t place_of(const BoardDevice& entry, std::string_view name, bool is_input) {
  std::size_t place = 0;
  for (const auto& variable : entry.variables) {
    if (variable.is_input() != is_input) continue;
    if (variable.name == name) return place;
    ++place;
  }
  return static_cast<std::size_t>(-1);
}

}  // namespace

DescribedDevice::DescribedDevice(const BoardDevice& entry, DeviceHost& host)
    : entry_(entry),
      host_(host),
      values_(entry.registers.size()),
      was_read_(entry.registers.size()),
      spent_(entry.states.size()),
      state_(state_index(entry.initial_state)) {
  MEBOTS_ASSERT(spent_.empty() || state_ < spent_.size(), "the board file names a state of the device");
  for (const auto& variable : entry.variables) (variable.is_input() ? inputs_ : outputs_).push_back(variable.start);
  const bool measures = std::ranges::any_of(entry.states, [](const auto& state) { return state.delay_s > 0; });
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = entry.registers[i].reset;
  for (const auto& described : entry.registers) {
    auto& reg = registers_.emplace_back();
    commits_ = commits_ || described.commits;
    reg.takes_opcodes =
        std::ranges::find(entry.opcodes, described.name, &BoardOpcode::register_name) != entry.opcodes.end();
    if (const auto* shown = entry.variable(described.shows)) {
      reg.input = place_of(entry, described.shows, true);
      reg.is_live = !measures || shown->causality == BoardVariable::Causality::parameter;
    }
    if (const auto* sent = entry.variable(described.sends)) {
      reg.output = place_of(entry, described.sends, false);
      const auto type = std::ranges::find(entry.enumerations, sent->type, &BoardEnumeration::name);
      if (type != entry.enumerations.end()) reg.items = &*type;
    }
  }
}

std::size_t DescribedDevice::register_at(std::uint32_t offset) const {
  const auto found = std::ranges::find(entry_.registers, offset, &BoardRegister::offset);
  return static_cast<std::size_t>(found - entry_.registers.begin());
}

std::size_t DescribedDevice::state_index(std::string_view name) const {
  const auto found = std::ranges::find(entry_.states, name, &BoardState::name);
  return static_cast<std::size_t>(found - entry_.states.begin());
}

std::string_view DescribedDevice::state_name() const {
  return entry_.states.empty() ? std::string_view() : entry_.states[state_].name;
}

double* DescribedDevice::input(std::string_view variable) {
  const auto place = place_of(entry_, variable, true);
  return place == kNone ? nullptr : &inputs_[place];
}

const double* DescribedDevice::output(std::string_view variable) const {
  const bool is_sent = std::ranges::find(entry_.registers, variable, &BoardRegister::sends) != entry_.registers.end();
  return is_sent ? &outputs_[place_of(entry_, variable, false)] : nullptr;
}

bool DescribedDevice::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  const auto index = register_at(offset);
  if (index == values_.size()) {
    value = 0;
    return pass_over(offset, "load from");
  }
  const auto& described = entry_.registers[index];
  const auto& reg = registers_[index];
  if (described.access == "w") return false;
  was_read_[index] = 1;
  if (described.shows == kStatus) {
    value = status_;
  } else if (reg.is_live) {
    value = to_register(inputs_[reg.input], described.units_per_si);
  } else {
    value = values_[index];
  }
  return true;
}

bool DescribedDevice::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  const auto index = register_at(offset);
  if (index == values_.size()) return pass_over(offset, "store into");
  const auto& described = entry_.registers[index];
  if (described.access == "r") return false;
  if (described.shows == kStatus) {
    status_ &= ~(value & (kReady | kRefused));
  } else if (registers_[index].takes_opcodes) {
    obey(index, value, now);
  } else if (described.commits) {
    send(0, registers_.size(), now);
  } else {
    values_[index] = value;
    if (!commits_) send(index, index + 1, now);
  }
  return true;
}

/// Handles an access to an offset without a register. If the entry has no `span`, returns false. Otherwise returns
/// true, and reports each offset once.
bool DescribedDevice::pass_over(std::uint32_t offset, std::string_view access) {
  if (entry_.span == 0) return false;
  if (std::ranges::find(warned_, offset) != warned_.end()) return true;
  warned_.push_back(offset);
  const auto function = host_.function();
  host_.complain(
      fmt::format("{}: {} 0x{:08x}{}{}: device {} has no register there. Loads give 0 and stores are lost. Add a "
                  "register to the board file to keep stored values",
                  entry_.name, access, entry_.base + offset, function.empty() ? "" : " in ", function, entry_.name));
  return true;
}

/// Sends the values of the registers in [first, last). Skips registers that do not send. If a value is invalid, sends
/// none of them.
void DescribedDevice::send(std::size_t first, std::size_t last, Picoseconds now) {
  for (auto i = first; i < last; ++i) {
    if (const auto fault = fault_of(i); !fault.empty()) {
      host_.complain(fmt::format("{}: {}: nothing was sent", entry_.name, fault));
      return;
    }
  }
  bool sends = false;
  for (auto i = first; i < last; ++i) {
    if (registers_[i].output == kNone) continue;
    outputs_[registers_[i].output] = from_register(values_[i], entry_.registers[i].units_per_si);
    sends = true;
  }
  if (sends) host_.setpoints_sent(entry_.name, now);
}

std::string DescribedDevice::fault_of(std::size_t reg) const {
  if (registers_[reg].output == kNone) return {};
  const auto& described = entry_.registers[reg];
  const auto value = static_cast<std::int32_t>(values_[reg]);
  if (described.least && value < *described.least) {
    return fmt::format("{} {} is below {}", described.name, value, *described.least);
  }
  if (described.most && value > *described.most) {
    return fmt::format("{} {} is above {}", described.name, value, *described.most);
  }
  const auto* items = registers_[reg].items;
  if (items == nullptr || std::ranges::find(items->items, value, &BoardValue::value) != items->items.end()) return {};
  std::string known;
  for (const auto& item : items->items) {
    known += fmt::format("{}{} {}", known.empty() ? "" : ", ", item.name, item.value);
  }
  return fmt::format("{} {} is not a value of {} ({})", described.name, value, items->name, known);
}

void DescribedDevice::obey(std::size_t reg, std::uint32_t value, Picoseconds now) {
  const auto& name = entry_.registers[reg].name;
  const auto opcode = std::ranges::find_if(entry_.opcodes, [&](const BoardOpcode& candidate) {
    return candidate.register_name == name && candidate.value == value;
  });
  const auto state = opcode == entry_.opcodes.end() ? entry_.states.size() : state_index(opcode->state);
  if (state == entry_.states.size() || (done_at_ != kNever && entry_.states[state].delay_s > 0)) {
    status_ |= kRefused;
    return;
  }
  enter(state, now);
}

void DescribedDevice::enter(std::size_t state, Picoseconds now) {
  MEBOTS_ASSERT(state < entry_.states.size() && state_ < spent_.size());
  MEBOTS_ASSERT(now >= since_, "calls come in the order of time");
  spent_[state_] += now - since_;
  since_ = now;
  state_ = state;
  const auto delay_s = entry_.states[state].delay_s;
  done_at_ = delay_s > 0 ? now + std::llround(delay_s * kPsPerS) : kNever;
  status_ = delay_s > 0 ? status_ | kBusy : status_ & ~kBusy;
}

void DescribedDevice::advance(Picoseconds now) {
  if (now < done_at_) return;
  measure();
  status_ |= kReady;
  enter(state_index(entry_.states[state_].then), done_at_);
}

void DescribedDevice::measure() {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (registers_[i].input == kNone) continue;
    values_[i] = to_register(inputs_[registers_[i].input], entry_.registers[i].units_per_si);
  }
}

double DescribedDevice::energy_j(Picoseconds now) const {
  double charge_as = 0;
  for (std::size_t i = 0; i < spent_.size(); ++i) {
    const auto time = spent_[i] + (i == state_ ? now - since_ : 0);
    charge_as += entry_.states[i].current_a * static_cast<double>(time) / kPsPerS;
  }
  return charge_as * entry_.supply_voltage_v;
}

void DescribedDevice::program_ended() {
  for (const auto& variable : entry_.variables) {
    if (variable.causality != BoardVariable::Causality::parameter || !variable.is_number()) continue;
    const auto value = inputs_[place_of(entry_, variable.name, true)];
    bool is_shown = false;
    bool is_read = false;
    for (std::size_t i = 0; i < registers_.size(); ++i) {
      const bool shows = entry_.registers[i].shows == variable.name;
      is_shown = is_shown || shows;
      is_read = is_read || (shows && was_read_[i] != 0);
    }
    if (value == variable.start || !is_shown || is_read) continue;
    host_.complain(fmt::format("{} = {} had no effect: the program ended without reading it", variable.name, value));
  }
}

void DescribedDevice::visit(state::Visitor& v) {
  v("inputs", std::span(inputs_));
  v("outputs", std::span(outputs_));
  v("values", std::span(values_));
  v("was_read", std::span(was_read_));
  v("spent", std::span(spent_));
  v("state", state_);
  if (state_ >= std::max<std::size_t>(1, spent_.size())) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: device " + entry_.name + " is in no state");
  }
  v("status", status_);
  v("since", since_);
  v("done_at", done_at_);
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(described, {}, make_of_entry<DescribedDevice>)
