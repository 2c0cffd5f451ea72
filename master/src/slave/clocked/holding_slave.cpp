// SPDX-License-Identifier: Apache-2.0
#include "slave/clocked/holding_slave.hpp"

#include "mebots/state/save.hpp"
#include "slave/member_state.hpp"

#include <algorithm>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;

/// Returns the start value of a variable; zero, false or an empty text if it has none.
LinkValue start_of(const modeldesc::Variable& variable) {
  const auto value_or = [&]<typename T>(const T& none) {
    const auto* const start = std::get_if<T>(&variable.start);
    return start == nullptr ? none : *start;
  };
  switch (kind_of(variable.type)) {
    case ValueKind::real:
      return value_or(0.0);
    case ValueKind::boolean:
      return std::int64_t{value_or(false)};
    case ValueKind::integer:
      return value_or(std::int64_t{0});
    default:
      return value_or(std::string());
  }
}

bool belongs_to(const modeldesc::Variable& variable, ValueReference clock) {
  return std::ranges::find(variable.fmi3->clocks, clock) != variable.fmi3->clocks.end();
}

}  // namespace

void HoldingSlave::Held::visit(state::Visitor& v) {
  v("waits", waits);
  v("value", value);
}

HoldingSlave::HoldingSlave(std::unique_ptr<Slave> inner) : ForwardingSlave(std::move(inner)) {
  for (const auto& variable : description().variables) {
    if (variable.fmi3->clocks.empty() || variable.type == modeldesc::Type::clock) continue;
    held_.emplace(variable.value_reference, Held{&variable, false, start_of(variable)});
  }
}

HoldingSlave::Held* HoldingSlave::held(ValueReference reference) {
  const auto found = held_.find(reference);
  return found == held_.end() ? nullptr : &found->second;
}

template <typename T>
void HoldingSlave::get(std::span<const ValueReference> references, std::span<T> values,
                       void (Slave::*from_inner)(std::span<const ValueReference>, std::span<T>)) {
  if (std::ranges::none_of(references, [&](auto reference) { return held(reference) != nullptr; })) {
    return (inner().*from_inner)(references, values);
  }
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (const auto* const variable = held(references[i])) {
      values[i] = std::get<T>(variable->value);
    } else {
      (inner().*from_inner)(references.subspan(i, 1), values.subspan(i, 1));
    }
  }
}

template <typename T>
void HoldingSlave::set(std::span<const ValueReference> references, std::span<const T> values,
                       void (Slave::*to_inner)(std::span<const ValueReference>, std::span<const T>)) {
  std::vector<ValueReference> others;
  std::vector<T> other_values;
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (auto* const variable = held(references[i])) {
      variable->value = values[i];
      variable->waits = true;
    } else {
      others.push_back(references[i]);
      other_values.push_back(values[i]);
    }
  }
  if (!others.empty()) (inner().*to_inner)(others, other_values);
}

void HoldingSlave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  get(references, values, &Slave::get_reals);
}
void HoldingSlave::get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  get(references, values, &Slave::get_integers);
}
void HoldingSlave::get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  get(references, values, &Slave::get_booleans);
}
void HoldingSlave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  get(references, values, &Slave::get_strings);
}
void HoldingSlave::get_binaries(std::span<const ValueReference> references, std::span<std::string> values) {
  get(references, values, &Slave::get_binaries);
}
void HoldingSlave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  set(references, values, &Slave::set_reals);
}
void HoldingSlave::set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  set(references, values, &Slave::set_integers);
}
void HoldingSlave::set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  set(references, values, &Slave::set_booleans);
}
void HoldingSlave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  set(references, values, &Slave::set_strings);
}
void HoldingSlave::set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) {
  set(references, values, &Slave::set_binaries);
}

void HoldingSlave::give_inputs(ValueReference clock) {
  for (auto& [reference, held] : held_) {
    if (!held.waits || !belongs_to(*held.variable, clock)) continue;
    set_value(inner(), kind_of(held.variable->type), reference, held.value);
    held.waits = false;
  }
}

void HoldingSlave::store_outputs(ValueReference clock) {
  for (auto& [reference, held] : held_) {
    if (held.variable->causality != Causality::output || !belongs_to(*held.variable, clock)) continue;
    held.value = get_value(inner(), kind_of(held.variable->type), reference);
  }
}

void HoldingSlave::visit(state::Visitor& v) {
  for (auto& [reference, held] : held_) v(held.variable->name, held);
}

std::unique_ptr<SlaveState> HoldingSlave::save_state() {
  auto state = std::make_unique<MemberState>();
  state->inner = inner().save_state();
  state->own = state::save(*this);
  return state;
}

void HoldingSlave::restore_state(const SlaveState& state) {
  const auto& saved = static_cast<const MemberState&>(state);
  inner().restore_state(*saved.inner);
  state::restore(*this, saved.own);
}

std::vector<std::byte> HoldingSlave::serialize(const SlaveState& state) {
  return serialize_member(inner(), static_cast<const MemberState&>(state));
}

std::unique_ptr<SlaveState> HoldingSlave::deserialize(std::span<const std::byte> bytes) {
  return deserialize_member(inner(), bytes);
}

}  // namespace mebots::master
