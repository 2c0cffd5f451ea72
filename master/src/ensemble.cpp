// SPDX-License-Identifier: Apache-2.0
#include "mebots/master/ensemble.hpp"

#include "mebots/master/time.hpp"

#include "slave_factory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variable;

/// Values settle in as many sweeps as the longest chain of connections has links; a loop that converges
/// gets some more. Both together stay far below this for any ensemble whose loop is a contraction.
constexpr int kExtraSweeps = 200;

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

/// Relative change below which a loop of initial values counts as settled.
constexpr double kSettled = 1e-12;

bool close(double a, double b) {
  return a == b || std::abs(a - b) <= kSettled * std::max(std::abs(a), std::abs(b));
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
  const auto found = std::find(variables.begin(), variables.end(), &variable);
  if (found != variables.end()) return static_cast<std::size_t>(found - variables.begin());
  references.push_back(variable.value_reference);
  variables.push_back(&variable);
  values.emplace_back();
  return values.size() - 1;
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
    : system_(&system) {
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
  switch (from.kind) {
    case ValueKind::real:
      target.real_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::integer:
      target.integer_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::boolean:
      target.boolean_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::string:
      target.string_copies.push_back({.signal = from, .slot = to});
      break;
  }
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
    step_order_.push_back(next);
  }
}

void Ensemble::set_starts(std::size_t instance) {
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
    set_starts(i);
    members_[i].slave->setup_experiment(0, stop_ns);
    members_[i].slave->enter_initialization();
  }
  propagate_initial_values();
  for (auto& member : members_) member.slave->exit_initialization();
  for (std::size_t i = 0; i < members_.size(); ++i) read_outputs(i, 0);
}

void Ensemble::propagate_initial_values() {
  // All outputs are read before any input is set, so that the order of the instances is nothing.
  // Without a loop the values stand still after as many sweeps as the longest chain has links.
  if (system_->connections.empty()) return;
  const auto sweeps = static_cast<int>(members_.size()) + kExtraSweeps;
  std::vector<Banks> before;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    before.clear();
    for (const auto& member : members_) before.push_back(member.outputs);
    for (std::size_t i = 0; i < members_.size(); ++i) read_outputs(i, 0);
    if (sweep > 0 && settled(before)) return;
    for (std::size_t i = 0; i < members_.size(); ++i) write_inputs(i);
  }
  const auto loop = initial_loop(*system_);
  throw Error(
      fmt::format("the initial values do not settle after {} sweeps along the connections{}. Cut the loop, or give the "
                  "FMUs other start values",
                  sweeps, loop.empty() ? "" : fmt::format("; they run in a loop: {}", loop)));
}

bool Ensemble::settled(const std::vector<Banks>& before) const {
  // Only what travels counts: a watched variable that nobody takes may be a clock of the FMU's own.
  return std::all_of(
      system_->connections.begin(), system_->connections.end(), [&](const ResolvedConnection& connection) {
        if (connection.pointer) return true;  // an FMU may hand out another buffer at each call
        const auto& old = before[connection.from.instance];
        const auto& now = members_[connection.from.instance].outputs;
        const auto same = [&](const auto& old_bank, const auto& bank, auto equal) {
          const auto found = std::find(bank.variables.begin(), bank.variables.end(), connection.from.variable);
          const auto slot = static_cast<std::size_t>(found - bank.variables.begin());
          return equal(old_bank.values[slot], bank.values[slot]);
        };
        switch (kind_of(connection.from.variable->type)) {
          case ValueKind::real:
            return same(old.reals, now.reals, close);
          case ValueKind::integer:
            return same(old.integers, now.integers, std::equal_to<>());
          case ValueKind::boolean:
            return same(old.booleans, now.booleans, std::equal_to<>());
          case ValueKind::string:
            break;
        }
        return same(old.strings, now.strings, std::equal_to<>());
      });
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
  auto& member = members_[instance];
  auto& outputs = member.outputs;
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

void Ensemble::write_inputs(std::size_t instance) {
  auto& member = members_[instance];
  if (member.input_kinds == 0) return;
  move_all(member.real_copies);
  move_all(member.integer_copies);
  move_all(member.boolean_copies);
  move_all(member.string_copies);
  write(*member.slave, member.inputs, member.input_kinds);
}

void Ensemble::save_values(state::Writer& writer) const {
  for (const auto& member : members_) {
    writer.put(member.outputs.reals.values);
    writer.put(member.outputs.integers.values);
    writer.put(member.outputs.booleans.values);
    for (const auto& text : member.outputs.strings.values) writer.put(text);
  }
}

void Ensemble::restore_values(state::Reader& reader) {
  const auto get = [&](auto& values) {
    const auto expected = values.size();
    reader.get(values);
    if (values.size() != expected)
      throw Error("a saved state belongs to another ensemble: its values are of another number");
  };
  for (auto& member : members_) {
    get(member.outputs.reals.values);
    get(member.outputs.integers.values);
    get(member.outputs.booleans.values);
    for (auto& text : member.outputs.strings.values) reader.get(text);
  }
}

}  // namespace mebots::master
