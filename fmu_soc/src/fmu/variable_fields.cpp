// SPDX-License-Identifier: Apache-2.0
#include "fmu/variable_fields.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace mebots::soc {
namespace {

fmu::Causality causality_of(const BoardVariable& variable) {
  switch (variable.causality) {
    case BoardVariable::Causality::parameter:
      return fmu::Causality::parameter;
    case BoardVariable::Causality::input:
      return fmu::Causality::input;
    case BoardVariable::Causality::output:
      break;
  }
  return fmu::Causality::output;
}

/// Throws Error if the FMU has no such field, because it was built with another board file.
template <typename Field>
auto required(const Field& field, const std::string& name) {
  if (!field) {
    throw Error(fmt::format("{}: this FMU has no variable {}; build the FMU again with this board file",
                            MEBOTS_SOC_BOARD, name));
  }
  return field;
}

/// Throws Error if the kind of the device does not have the variable.
template <typename T>
T* known(T* place, const BoardDevice& entry, const std::string& name) {
  if (place == nullptr) {
    throw Error(
        fmt::format("{}: device {}: its kind {} has no variable {}", MEBOTS_SOC_BOARD, entry.name, entry.kind, name));
  }
  return place;
}

/// Returns `*before`, the value of the previous step, if it is equal to `values`. Otherwise returns a copy of `values`.
template <typename T, typename Values>
std::shared_ptr<const T> shared_copy(const std::shared_ptr<const T>* before, const Values& values) {
  if (before != nullptr && std::ranges::equal(**before, values)) return *before;
  return std::make_shared<const T>(values.begin(), values.end());
}

}  // namespace

VariableFields::VariableFields(Soc& soc, void* variables) : soc_(soc) {
  for (const auto& slot : soc.devices()) {
    energies_.push_back({slot.device, {}, {}});
    for (const auto& variable : slot.entry->variables) find(slot, variable, variables);
    if (!energies_.back().power_w && !energies_.back().energy_j) energies_.pop_back();
  }
}

void VariableFields::find(const DeviceSet::Member& slot, const BoardVariable& variable, void* variables) {
  const auto& name = variable.name;
  const auto causality = causality_of(variable);
  if (variable.type == "String") {
    auto* field = required(fmu::text_field(variables, causality, name), name);
    if (variable.is_input()) {
      texts_.push_back({field, known(slot.device->text_input(name), *slot.entry, name)});
    } else {
      text_outputs_.push_back({known(slot.device->text_output(name), *slot.entry, name), field});
    }
    return;
  }
  if (variable.type == "Binary") {
    const auto* from = required(fmu::binary_field(variables, causality, name), name);
    bytes_.push_back({from, known(slot.device->bytes_input(name), *slot.entry, name)});
    return;
  }
  const auto field = *required(fmu::number_field(variables, causality, name), name);
  if (variable.is_input()) {
    auto* to = known(slot.device->input(name), *slot.entry, name);
    numbers_.push_back({name, field, to});
    if (name == soc_.board().supply.variable) supply_v_ = to;
  } else if (name == slot.entry->power_variable()) {
    energies_.back().power_w = field;
  } else if (name == slot.entry->energy_variable()) {
    energies_.back().energy_j = field;
  } else {
    outputs_.push_back({known(slot.device->output(name), *slot.entry, name), field});
  }
}

void VariableFields::take() {
  for (const auto& number : numbers_) {
    const auto value = number.from.get();
    if (!std::isfinite(value)) throw Error(fmt::format("{} = {} must be a finite number", number.name, value));
    *number.to = value;
  }
  for (const auto& text : texts_) *text.to = *text.from;
  for (const auto& bytes : bytes_) *bytes.to = bytes.from->bytes();
  begin_energies();
}

void VariableFields::begin_energies() {
  for (auto& energy : energies_) energy.before_j = soc_.power().energy_j(*energy.device);
}

StepInputs VariableFields::inputs(const StepInputs* before) const {
  StepInputs inputs;
  for (const auto& number : numbers_) inputs.numbers.push_back(*number.to);
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    inputs.texts.push_back(shared_copy(before == nullptr ? nullptr : &before->texts[i], *texts_[i].from));
  }
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    inputs.bytes.push_back(shared_copy(before == nullptr ? nullptr : &before->bytes[i], bytes_[i].from->bytes()));
  }
  return inputs;
}

void VariableFields::set(const StepInputs& inputs) {
  for (std::size_t i = 0; i < numbers_.size(); ++i) *numbers_[i].to = inputs.numbers[i];
  for (std::size_t i = 0; i < texts_.size(); ++i) *texts_[i].to = *inputs.texts[i];
  for (std::size_t i = 0; i < bytes_.size(); ++i) *bytes_[i].to = *inputs.bytes[i];
  begin_energies();
}

void VariableFields::write(double step_s) {
  for (const auto& output : outputs_) output.to.set(*output.from);
  for (const auto& output : text_outputs_) *output.to = *output.from;
  for (const auto& energy : energies_) {
    const auto now_j = soc_.power().energy_j(*energy.device);
    if (energy.energy_j) energy.energy_j->set(now_j);
    if (energy.power_w && step_s > 0) energy.power_w->set((now_j - energy.before_j) / step_s);
  }
}

}  // namespace mebots::soc
