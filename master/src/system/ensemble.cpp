// SPDX-License-Identifier: Apache-2.0
#include "system/ensemble.hpp"

#include "base/interrupt.hpp"
#include "base/time.hpp"
#include "mebots/assert.hpp"

#include "slave/slave_factory.hpp"
#include "system/initial_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variable;

/// Before t = 0 a slave that refuses something refuses what it was given: its files, parameters, start values.
template <typename Work>
auto as_input(Work work) {
  try {
    return work();
  } catch (const NotFiniteError&) {
    throw;
  } catch (const SlaveError& error) {
    throw InputError(error.what());
  }
}

}  // namespace

ValueKind kind_of(Type type) {
  switch (type) {
    case Type::real:
      return ValueKind::real;
    case Type::integer:
    case Type::enumeration:
      return ValueKind::integer;
    case Type::boolean:
      return ValueKind::boolean;
    case Type::string:
      break;
  }
  return ValueKind::string;
}

template <typename T>
std::size_t Bank<T>::slot(const Variable& variable) {
  const auto [found, added] = slots.emplace(&variable, values.size());
  MEBOTS_ASSERT(references.size() == values.size() && variables.size() == values.size(),
                "a bank is three lists side by side");
  if (!added) return found->second;
  references.push_back(variable.value_reference);
  variables.push_back(&variable);
  values.emplace_back();
  return found->second;
}

namespace {

std::size_t slot_in(Banks& banks, const Variable& variable) {
  switch (kind_of(variable.type)) {
    case ValueKind::real:
      return banks.reals.slot(variable);
    case ValueKind::integer:
      return banks.integers.slot(variable);
    case ValueKind::boolean:
      return banks.booleans.slot(variable);
    case ValueKind::string:
      break;
  }
  return banks.strings.slot(variable);
}

KindSet kinds_in(const Banks& banks) {
  KindSet kinds = 0;
  if (!banks.reals.values.empty()) kinds |= bit(ValueKind::real);
  if (!banks.integers.values.empty()) kinds |= bit(ValueKind::integer);
  if (!banks.booleans.values.empty()) kinds |= bit(ValueKind::boolean);
  if (!banks.strings.values.empty()) kinds |= bit(ValueKind::string);
  return kinds;
}

void write(Slave& slave, const Banks& banks, KindSet kinds) {
  if ((kinds & bit(ValueKind::real)) != 0) slave.set_reals(banks.reals.references, banks.reals.values);
  if ((kinds & bit(ValueKind::integer)) != 0) slave.set_integers(banks.integers.references, banks.integers.values);
  if ((kinds & bit(ValueKind::boolean)) != 0) slave.set_booleans(banks.booleans.references, banks.booleans.values);
  if ((kinds & bit(ValueKind::string)) != 0) slave.set_strings(banks.strings.references, banks.strings.values);
}

/// Moves the values of one kind along their connections.
template <typename Copies>
void move_all(const Copies& copies) {
  for (const auto& copy : copies) *copy.to = *copy.from;
}

}  // namespace

Ensemble::Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : system_(&system), interrupted_(options.interrupted != nullptr ? options.interrupted : &kNeverInterrupted) {
  auto slaves = as_input([&] { return make_slaves(system, messages, options); });
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    Member member;
    member.slave = std::move(slaves[i]);
    member.step_ns = system.instances[i].description->step_ns;
    members_.push_back(std::move(member));
  }
  for (const auto& connection : system.connections) connect(connection);
  order_steps();
}

SignalId Ensemble::watch(const ResolvedVariable& variable) {
  return {variable.instance, kind_of(variable.variable->type),
          slot_in(members_[variable.instance].outputs, *variable.variable)};
}

void Ensemble::connect(const ResolvedConnection& connection) {
  const auto from = watch(connection.from);
  auto& target = members_[connection.to.instance];
  const auto to = slot_in(target.inputs, *connection.to.variable);
  switch (kind_of(connection.to.variable->type)) {
    case ValueKind::real:
      if (from.kind == ValueKind::real && !connection.changes_value()) {
        target.real_copies.push_back({.signal = from, .slot = to});
      } else {
        target.conversions.push_back({from, to, connection.factor, connection.offset});
      }
      if (from.kind == ValueKind::real) link_derivatives(connection);
      break;
    case ValueKind::integer:
      (from.kind == ValueKind::boolean ? target.flag_copies : target.integer_copies)
          .push_back({.signal = from, .slot = to});
      break;
    case ValueKind::boolean:
      target.boolean_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::string:
      target.string_copies.push_back({.signal = from, .slot = to});
      break;
  }
}

void Ensemble::link_derivatives(const ResolvedConnection& connection) {
  using modeldesc::Variability;
  auto& target = members_[connection.to.instance];
  const auto orders = members_[connection.from.instance].slave->output_derivative_order();
  const bool continuous = connection.from.variable->variability == Variability::continuous &&
                          connection.to.variable->variability == Variability::continuous;
  if (orders == 0 || !continuous || !target.slave->takes_input_derivatives()) return;
  target.derivatives.push_back({connection.from.instance, connection.from.variable->value_reference,
                                connection.to.variable->value_reference, connection.factor, orders});
}

void Ensemble::order_steps() {
  // A reader steps before the owner of its buffer; otherwise the order of the config holds.
  std::vector<std::set<std::size_t>> readers(members_.size());
  for (const auto& connection : system_->connections) {
    if (connection.pointer && connection.from.instance != connection.to.instance) {
      readers[connection.from.instance].insert(connection.to.instance);
    }
  }
  std::vector<bool> placed(members_.size(), false);
  while (step_order_.size() < members_.size()) {
    const auto is_free = [&](std::size_t i) {
      return !placed[i] &&
             std::all_of(readers[i].begin(), readers[i].end(), [&](std::size_t reader) { return placed[reader]; });
    };
    std::size_t next = members_.size();
    for (std::size_t i = 0; i < members_.size() && next == members_.size(); ++i) {
      if (is_free(i)) next = i;
    }
    if (next == members_.size()) {  // buffers in a ring: their owners keep two, as OSMP asks
      next = static_cast<std::size_t>(std::find(placed.begin(), placed.end(), false) - placed.begin());
    }
    placed[next] = true;
    MEBOTS_ASSERT(step_order_.size() < members_.size());
    step_order_.push_back(next);
  }
}

void Ensemble::set_starts(std::size_t instance) {
  MEBOTS_ASSERT(instance < members_.size() && system_->instances.size() == members_.size());
  Banks banks;
  for (const auto& start : system_->instances[instance].starts) {
    const auto slot = slot_in(banks, *start.variable);
    switch (kind_of(start.variable->type)) {
      case ValueKind::real:
        banks.reals.values[slot] = std::get<double>(start.value);
        break;
      case ValueKind::integer:
        banks.integers.values[slot] = std::get<std::int32_t>(start.value);
        break;
      case ValueKind::boolean:
        banks.booleans.values[slot] = std::get<bool>(start.value) ? 1 : 0;
        break;
      case ValueKind::string:
        banks.strings.values[slot] = std::get<std::string>(start.value);
        break;
    }
  }
  write(*members_[instance].slave, banks, kinds_in(banks));
}

void Ensemble::lay_out() {
  const auto addresses = [](auto& copies, auto source, auto& targets) {
    for (auto& copy : copies) {
      copy.from = source(copy.signal);
      MEBOTS_ASSERT(copy.slot < targets.size());
      MEBOTS_ASSERT(copy.from != nullptr);
      copy.to = &targets[copy.slot];
    }
  };
  for (auto& member : members_) {
    member.output_kinds = kinds_in(member.outputs);
    member.input_kinds = kinds_in(member.inputs);
    addresses(
        member.real_copies, [&](SignalId id) { return &real(id); }, member.inputs.reals.values);
    addresses(
        member.integer_copies, [&](SignalId id) { return &integer(id); }, member.inputs.integers.values);
    addresses(
        member.flag_copies, [&](SignalId id) { return &integer(id); }, member.inputs.integers.values);
    addresses(
        member.boolean_copies, [&](SignalId id) { return &integer(id); }, member.inputs.booleans.values);
    addresses(
        member.string_copies, [&](SignalId id) { return &string(id); }, member.inputs.strings.values);
  }
}

void Ensemble::initialize(std::int64_t stop_ns) {
  as_input([&] { initialize_slaves(stop_ns); });
}

void Ensemble::initialize_slaves(std::int64_t stop_ns) {
  lay_out();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    stop_if_interrupted(*interrupted_);
    set_starts(i);
    members_[i].slave->setup_experiment(0, stop_ns);
    members_[i].slave->enter_initialization();
  }
  InitialValues(*this).settle();
  for (auto& member : members_) {
    stop_if_interrupted(*interrupted_);
    member.slave->exit_initialization();
  }
  for (std::size_t i = 0; i < members_.size(); ++i) read_outputs(i, 0);
}

void Ensemble::terminate() {
  // Every slave is told, also after one that complains: some write their files only now.
  std::exception_ptr first;
  for (auto& member : members_) {
    try {
      member.slave->terminate();
    } catch (const SlaveError&) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

void Ensemble::read_outputs(std::size_t instance, std::int64_t time_ns) {
  MEBOTS_ASSERT(instance < members_.size());
  MEBOTS_ASSERT(time_ns >= 0);
  auto& member = members_[instance];
  auto& outputs = member.outputs;
  member.outputs_time_ns = time_ns;
  const auto kinds = member.output_kinds;
  if (kinds == 0) return;
  if ((kinds & bit(ValueKind::real)) != 0) {
    member.slave->get_reals(outputs.reals.references, outputs.reals.values);
    check_finite(member, time_ns);
  }
  if ((kinds & bit(ValueKind::integer)) != 0)
    member.slave->get_integers(outputs.integers.references, outputs.integers.values);
  if ((kinds & bit(ValueKind::boolean)) != 0)
    member.slave->get_booleans(outputs.booleans.references, outputs.booleans.values);
  if ((kinds & bit(ValueKind::string)) != 0)
    member.slave->get_strings(outputs.strings.references, outputs.strings.values);
}

void Ensemble::check_finite(const Member& member, std::int64_t time_ns) const {
  const auto& bank = member.outputs.reals;
  for (std::size_t i = 0; i < bank.values.size(); ++i) {
    if (std::isfinite(bank.values[i])) continue;
    throw NotFiniteError(fmt::format(
        "instance '{}' at {} s: the variable '{}' is {}; nothing sensible can follow. Check the "
        "inputs and parameters of '{}', or take a smaller step",
        member.slave->name(), to_seconds(time_ns), bank.variables[i]->name, bank.values[i], member.slave->name()));
  }
}

double Ensemble::number(SignalId id) const {
  if (id.kind == ValueKind::real) return real(id);
  return id.kind == ValueKind::boolean && integer(id) != 0 ? 1 : integer(id);
}

void Ensemble::collect_inputs(std::size_t instance) {
  MEBOTS_ASSERT(instance < members_.size());
  auto& member = members_[instance];
  move_all(member.real_copies);
  move_all(member.integer_copies);
  move_all(member.boolean_copies);
  move_all(member.string_copies);
  for (const auto& copy : member.flag_copies) *copy.to = *copy.from == 0 ? 0 : 1;
  if (!member.conversions.empty()) convert(member);
}

void Ensemble::convert(Member& member) const {
  for (const auto& conversion : member.conversions) {
    MEBOTS_ASSERT(conversion.to < member.inputs.reals.values.size());
    const double value = conversion.factor * number(conversion.from) + conversion.offset;
    if (!std::isfinite(value)) {
      throw NotFiniteError(fmt::format("instance '{}' at {} s: the input '{}' would be {}, as {} x {} + {}",
                                       member.slave->name(), to_seconds(member.outputs_time_ns),
                                       member.inputs.reals.variables[conversion.to]->name, value, conversion.factor,
                                       number(conversion.from), conversion.offset));
    }
    member.inputs.reals.values[conversion.to] = value;
  }
}

void Ensemble::hand_inputs(std::size_t instance) {
  MEBOTS_ASSERT(instance < members_.size());
  auto& member = members_[instance];
  write(*member.slave, member.inputs, member.input_kinds);
}

void Ensemble::write_inputs(std::size_t instance, std::int64_t time_ns) {
  if (members_[instance].input_kinds == 0) return;
  collect_inputs(instance);
  hand_inputs(instance);
  // Before the first step no FMU knows derivatives.
  if (time_ns > 0 && !members_[instance].derivatives.empty()) write_derivatives(members_[instance], time_ns);
}

void Ensemble::write_derivatives(Member& member, std::int64_t time_ns) {
  for (const auto& link : member.derivatives) {
    MEBOTS_ASSERT(link.orders > 0 && link.from_instance < members_.size(), "link_derivatives() makes no empty ones");
    std::vector<std::int32_t> orders(link.orders);
    std::iota(orders.begin(), orders.end(), 1);
    std::vector<double> values(link.orders, 0);
    auto& source = members_[link.from_instance];
    // A source that stands at another time holds its value as far as this slave can see.
    if (source.outputs_time_ns == time_ns) {
      const std::vector<ValueReference> references(link.orders, link.from);
      source.slave->get_output_derivatives(references, orders, values);
      for (auto& value : values) value *= link.factor;
    }
    member.slave->set_input_derivatives(std::vector<ValueReference>(link.orders, link.to), orders, values);
  }
}

std::vector<Banks> Ensemble::outputs() const {
  std::vector<Banks> result;
  result.reserve(members_.size());
  for (const auto& member : members_) result.push_back(member.outputs);
  return result;
}

void Ensemble::bring_back(const std::vector<Banks>& outputs) {
  // Only values: observers hold on to their addresses.
  for (std::size_t i = 0; i < members_.size(); ++i) {
    MEBOTS_ASSERT(outputs.size() == members_.size(), "they come from outputs()");
    auto& now = members_[i].outputs;
    MEBOTS_ASSERT(outputs[i].reals.values.size() == now.reals.values.size());
    MEBOTS_ASSERT(outputs[i].strings.values.size() == now.strings.values.size());
    std::ranges::copy(outputs[i].reals.values, now.reals.values.begin());
    std::ranges::copy(outputs[i].integers.values, now.integers.values.begin());
    std::ranges::copy(outputs[i].booleans.values, now.booleans.values.begin());
    std::ranges::copy(outputs[i].strings.values, now.strings.values.begin());
  }
}

void Ensemble::visit(state::Visitor& v) {
  for (auto& member : members_) {
    const auto& name = member.slave->name();
    v(name + ".reals", std::span(member.outputs.reals.values));
    v(name + ".integers", std::span(member.outputs.integers.values));
    v(name + ".booleans", std::span(member.outputs.booleans.values));
    v(name + ".strings", std::span(member.outputs.strings.values));
  }
}

}  // namespace mebots::master
