// SPDX-License-Identifier: Apache-2.0
#include "engine/ensemble.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/fmu/binary_ref.hpp"
#include "message/message_text.hpp"

#include "engine/initial_values.hpp"
#include "fmi/call/callbacks.hpp"
#include "slave/isolation/child_process.hpp"
#include "slave/isolation/isolated_slave.hpp"
#include "slave/process_watch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variable;

/// Calls `work` and converts SlaveError to InputError, because errors before the first step result from files,
/// parameters or start values.
template <typename Work>
auto as_input(Work work) {
  try {
    return work();
  } catch (const NotFiniteError&) {
    throw;
  } catch (const SlaveError& error) {
    throw InputError(error.code(), error.what());
  }
}

/// Raises the limit of open files for the isolated instances. Must be called before the first process starts and the
/// first FMU is instantiated.
void reserve_descriptors(const ResolvedSystem& system) {
  const auto count =
      std::ranges::count_if(system.instances, [](const auto& instance) { return instance.isolation.alone(); });
  isolation::reserve_descriptors(static_cast<std::size_t>(count), isolation::IsolatedSlave::kDescriptors);
}

}  // namespace

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
    case ValueKind::binary:
      return banks.binaries.slot(variable);
    case ValueKind::clock:
      MEBOTS_ASSERT(false, "clocks are read and set in events only");
      [[fallthrough]];
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
  if (!banks.binaries.values.empty()) kinds |= bit(ValueKind::binary);
  return kinds;
}

void write(Slave& slave, const Banks& banks, KindSet kinds) {
  if ((kinds & bit(ValueKind::real)) != 0) slave.set_reals(banks.reals.references, banks.reals.values);
  if ((kinds & bit(ValueKind::integer)) != 0) slave.set_integers(banks.integers.references, banks.integers.values);
  if ((kinds & bit(ValueKind::boolean)) != 0) slave.set_booleans(banks.booleans.references, banks.booleans.values);
  if ((kinds & bit(ValueKind::string)) != 0) slave.set_strings(banks.strings.references, banks.strings.values);
  if ((kinds & bit(ValueKind::binary)) != 0) slave.set_binaries(banks.binaries.references, banks.binaries.values);
}

template <typename Copies>
void move_all(const Copies& copies) {
  for (const auto& copy : copies) *copy.to = *copy.from;
}

/// Returns the mapped value. If the map has no entry for `value`, returns `value`.
std::int64_t in_map(const std::vector<ValuePair>& map, std::int64_t value) {
  const auto found = std::ranges::lower_bound(map, value, {}, &ValuePair::from);
  return found != map.end() && found->from == value ? found->to : value;
}

}  // namespace

Ensemble::Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : system_(&system),
      messages_(&messages),
      interrupted_(options.interrupted != nullptr ? options.interrupted : &kNeverInterrupted),
      grid_(system.description->grid()) {
  reserve_descriptors(system);
  ProcessWatch watch(system, messages);
  auto slaves = as_input([&] { return make_slaves(system, messages, options); });
  watch.look("while instances were created", system.description->start_time_ns);
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    Member member;
    member.slave = std::move(slaves[i]);
    members_.push_back(std::move(member));
  }
  for (const auto& connection : system.connections) {
    if (!connection.inner) connect(connection);
  }
  for (auto& member : members_) {
    for_each_input_list(member, [&](const auto& list) { member.outer_sizes.push_back(list.size()); });
  }
  for (const auto& connection : system.connections) {
    if (connection.inner) connect(connection);
  }
  order_steps();
}

/// Calls `action` with each vector of `member` that has entries for connected inputs, such as references, values and
/// copies.
template <typename Action>
void Ensemble::for_each_input_list(Member& member, Action action) {
  const auto bank_lists = [&](auto& bank) {
    action(bank.references);
    action(bank.variables);
    action(bank.values);
  };
  bank_lists(member.inputs.reals);
  bank_lists(member.inputs.integers);
  bank_lists(member.inputs.booleans);
  bank_lists(member.inputs.strings);
  action(member.real_copies);
  action(member.integer_copies);
  action(member.flag_copies);
  action(member.boolean_copies);
  action(member.string_copies);
  action(member.conversions);
  action(member.mappings);
  action(member.item_checks);
  action(member.range_checks);
}

/// Removes the connections inside continuous systems. Their entries are at the end of each vector of
/// for_each_input_list(). After initialisation, the continuous systems transfer these values.
void Ensemble::drop_inner_connections() {
  for (auto& member : members_) {
    auto size = member.outer_sizes.begin();
    for_each_input_list(member, [&](auto& list) {
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(*size), list.end());
      ++size;
    });
    choose_input_path(member);
  }
}

SignalId Ensemble::watch(const ResolvedVariable& variable) {
  const auto& watched = *variable.variable;
  if (watched.type == modeldesc::Type::clock ||
      (is_clocked(watched) && !system_->instances[variable.instance].clocks_tick)) {
    throw InputError(
        ErrorCode::not_offered,
        fmt::format("{}: a Clock has no value between its ticks, and in co-simulation clocks tick only in FMUs "
                    "with hasEventMode = true; use variables without a clock",
                    system_->text(variable)));
  }
  return {variable.instance, kind_of(variable.variable->type),
          slot_in(members_[variable.instance].outputs, *variable.variable)};
}

void Ensemble::connect_binary(const ResolvedConnection& connection) {
  const bool from_triple = connection.from.variable->type != Type::binary;
  const auto& triple = from_triple ? connection.from : connection.to;
  if (!triple.variable->name.ends_with(kOsmpEndings[0])) return;  // the first variable represents all three
  const auto& model = *system_->instances[triple.instance].model;
  auto& target = members_[connection.to.instance];
  BytesOfTriple bytes{{}, 0};
  TripleOfBytes parts{{}, {}};
  for (std::size_t i = 0; i < bytes.parts.size(); ++i) {
    const auto prefix = triple.variable->name.substr(0, triple.variable->name.size() - std::strlen(kOsmpEndings[0]));
    const auto* part = model.find(prefix + kOsmpEndings[i]);
    MEBOTS_ASSERT(part != nullptr);
    if (from_triple) {
      bytes.parts[i] = watch({triple.instance, part});
    } else {
      parts.slots[i] = slot_in(target.inputs, *part);
    }
  }
  if (from_triple) {
    bytes.slot = slot_in(target.inputs, *connection.to.variable);
    target.bytes_of_triples.push_back(bytes);
  } else {
    parts.binary = watch(connection.from);
    target.triples_of_bytes.push_back(std::move(parts));
  }
}

void Ensemble::convert_binaries(Member& member) const {
  for (const auto& triple : member.bytes_of_triples) {
    const auto& parts = triple.parts;
    const auto part = [&](std::size_t i) { return static_cast<std::int32_t>(integer(parts[i])); };
    const auto bytes = fmu::BinaryRef{part(0), part(1), part(2)}.bytes();
    if (!is_readable(bytes)) {
      throw SlaveError(
          fmt::format("instance '{}' returned the address {} for {} bytes of the input '{}' of '{}', and this memory "
                      "cannot be read",
                      members_[parts[0].instance].slave->name(), fmt::ptr(bytes.data()), bytes.size(),
                      member.inputs.binaries.variables[triple.slot]->name, member.slave->name()));
    }
    member.inputs.binaries.values[triple.slot].assign(bytes.begin(), bytes.end());
  }
  for (auto& triple : member.triples_of_bytes) {
    triple.bytes = string(triple.binary);
    const auto ref =
        fmu::BinaryRef::to({reinterpret_cast<const std::uint8_t*>(triple.bytes.data()), triple.bytes.size()});
    auto& values = member.inputs.integers.values;
    values[triple.slots[0]] = triple.bytes.empty() ? 0 : ref.base_lo;
    values[triple.slots[1]] = triple.bytes.empty() ? 0 : ref.base_hi;
    values[triple.slots[2]] = ref.size;
  }
}

void Ensemble::connect(const ResolvedConnection& connection) {
  if (connection.converts) return connect_binary(connection);
  const auto from = watch(connection.from);
  auto& target = members_[connection.to.instance];
  const auto to = slot_in(target.inputs, *connection.to.variable);
  if (!connection.map.empty()) return connect_mapped(connection, from, to);
  if (connection.narrows) target.range_checks.push_back({&connection, to});
  switch (kind_of(connection.to.variable->type)) {
    case ValueKind::real:
      connect_real(connection, from, to);
      break;
    case ValueKind::integer:
      (from.kind == ValueKind::boolean ? target.flag_copies : target.integer_copies)
          .push_back({.signal = from, .slot = to});
      if (connection.to.variable->type == Type::enumeration && connection.from.variable->type != Type::enumeration) {
        check_items_of(connection, to);
      }
      break;
    case ValueKind::boolean:
      target.boolean_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::string:
      target.string_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::binary:
      target.binary_copies.push_back({.signal = from, .slot = to});
      break;
    case ValueKind::clock:
      MEBOTS_ASSERT(false, "connections of clocks are not among these");
  }
}

void Ensemble::connect_real(const ResolvedConnection& connection, SignalId from, std::size_t to) {
  auto& target = members_[connection.to.instance];
  if (connection.sum) {
    // The connections of a sum are adjacent. Derivatives of a sum are not transferred, so its input is constant during
    // a step.
    const bool add = !target.conversions.empty() && target.conversions.back().to == to;
    target.conversions.push_back({from, to, connection.factor, connection.offset, add});
    return;
  }
  if (from.kind == ValueKind::real && !connection.changes_value()) {
    target.real_copies.push_back({.signal = from, .slot = to});
  } else {
    target.conversions.push_back({from, to, connection.factor, connection.offset, false});
  }
  if (from.kind == ValueKind::real) link_derivatives(connection, from, to);
}

void Ensemble::connect_mapped(const ResolvedConnection& connection, SignalId from, std::size_t to) {
  const auto type = connection.to.variable->type;
  members_[connection.to.instance].mappings.push_back({{.signal = from, .slot = to}, kind_of(type), &connection.map});
  const bool is_whole = type != Type::boolean && type != Type::enumeration;
  if (is_whole && connection.from.variable->type != type)  // values without an entry in the map may be out of range
    members_[connection.to.instance].range_checks.push_back({&connection, to});
  if (type == Type::enumeration) check_items_of(connection, to);  // values without an entry may be invalid items
}

void Ensemble::check_items_of(const ResolvedConnection& connection, std::size_t slot) {
  auto& target = members_[connection.to.instance];
  ItemCheck check{&connection, slot, {}};
  const auto* type = target.slave->description().type_definition(connection.to.variable->declared_type);
  if (type != nullptr) {
    for (const auto& item : type->items) check.items.push_back(item.value);
  }
  target.item_checks.push_back(std::move(check));
}

std::size_t Ensemble::Derivatives::place(ValueReference reference, std::uint32_t most) {
  const auto [found, added] = firsts.emplace(reference, references.size());
  if (!added) return found->second;
  for (std::uint32_t order = 1; order <= most; ++order) {
    references.push_back(reference);
    orders.push_back(static_cast<std::int32_t>(order));
    values.push_back(0);
  }
  return found->second;
}

std::span<const double> Ensemble::Derivatives::of(ValueReference reference) const {
  const auto found = firsts.find(reference);
  if (found == firsts.end()) return {};
  auto end = found->second;
  while (end < references.size() && references[end] == reference) ++end;
  return std::span(values).subspan(found->second, end - found->second);
}

InputCourse Ensemble::course_of(const ResolvedVariable& input) const {
  const auto& member = members_[input.instance];
  const auto slot = member.inputs.reals.slots.find(input.variable);
  MEBOTS_ASSERT(slot != member.inputs.reals.slots.end(), "the input is a Real and connected");
  return {&member.inputs_time_ns, &member.inputs.reals.values[slot->second],
          member.input_derivatives.of(input.variable->value_reference)};
}

void Ensemble::link_derivatives(const ResolvedConnection& connection, SignalId from, std::size_t to) {
  using modeldesc::Variability;
  auto& target = members_[connection.to.instance];
  const auto orders = members_[connection.from.instance].slave->output_derivative_order();
  const bool continuous = connection.from.variable->variability == Variability::continuous &&
                          connection.to.variable->variability == Variability::continuous;
  if (connection.inner || orders == 0 || !continuous || !target.slave->takes_input_derivatives()) return;
  auto& source = members_[connection.from.instance];
  target.derivatives.push_back(
      {.connection = &connection,
       .from = from,
       .to = to,
       .from_first = source.output_derivatives.place(connection.from.variable->value_reference, orders),
       .to_first = target.input_derivatives.place(connection.to.variable->value_reference, orders),
       .orders = orders});
  source.keeps_earlier = true;
}

void Ensemble::order_steps() {
  // An instance that reads a buffer must step before the owner of the buffer. Otherwise, the order is that of the
  // config.
  std::vector<std::set<std::size_t>> owners(members_.size());
  std::vector<std::size_t> readers_left(members_.size(), 0);
  for (const auto& connection : system_->connections) {
    const auto owner = connection.from.instance;
    const auto reader = connection.to.instance;
    if (connection.pointer && owner != reader && owners[reader].insert(owner).second) ++readers_left[owner];
  }
  std::set<std::size_t> left;
  std::set<std::size_t> free;  // instances that need not wait for another reader
  for (std::size_t i = 0; i < members_.size(); ++i) {
    left.insert(left.end(), i);
    if (readers_left[i] == 0) free.insert(free.end(), i);
  }
  while (!left.empty()) {
    // If instances read OSMP buffers of each other in a cycle, `free` is empty. Then any order is correct, because OSMP
    // requires the owner of a buffer to keep two buffers.
    const auto next = free.empty() ? *left.begin() : *free.begin();
    free.erase(next);
    left.erase(next);
    step_order_.push_back(next);
    for (const auto owner : owners[next]) {
      if (--readers_left[owner] == 0 && left.contains(owner)) free.insert(owner);
    }
  }
  MEBOTS_ASSERT(step_order_.size() == members_.size());
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
        banks.integers.values[slot] = std::get<std::int64_t>(start.value);
        break;
      case ValueKind::boolean:
        banks.booleans.values[slot] = std::get<bool>(start.value) ? 1 : 0;
        break;
      case ValueKind::string:
        banks.strings.values[slot] = std::get<std::string>(start.value);
        break;
      case ValueKind::binary:
        banks.binaries.values[slot] = std::get<std::string>(start.value);
        break;
      case ValueKind::clock:
        MEBOTS_ASSERT(false, "a clock has no start value");
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
    if (member.keeps_earlier) member.earlier_reals.resize(member.outputs.reals.values.size());
    choose_input_path(member);
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
    addresses(
        member.binary_copies, [&](SignalId id) { return &string(id); }, member.inputs.binaries.values);
    for (auto& mapping : member.mappings) {
      auto& bank = mapping.kind == ValueKind::boolean ? member.inputs.booleans : member.inputs.integers;
      mapping.copy.from = &integer(mapping.copy.signal);
      mapping.copy.to = &bank.values[mapping.copy.slot];
    }
  }
}

void Ensemble::choose_input_path(Member& member) {
  member.input_kinds = kinds_in(member.inputs);
  member.takes_reals_as_they_are = member.input_kinds == bit(ValueKind::real) && member.conversions.empty() &&
                                   member.derivatives.empty() && member.range_checks.empty();
}

void Ensemble::initialize(std::int64_t stop_ns) {
  ProcessWatch watch(*system_, *messages_);
  as_input([&] { initialize_slaves(stop_ns); });
  watch.look("in initialisation", system_->description->start_time_ns);
}

void Ensemble::initialize_slaves(std::int64_t stop_ns) {
  const auto start_ns = system_->description->start_time_ns;
  lay_out();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    stop_if_interrupted(*interrupted_);
    set_starts(i);
    members_[i].slave->setup_experiment(system_->instances[i].experiment(start_ns, stop_ns));
    members_[i].slave->enter_initialization();
  }
  InitialValues(*this).settle();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].range_checks.empty()) continue;
    collect_inputs(i);
    check_ranges(members_[i], start_ns);
  }
  for (auto& member : members_) {
    stop_if_interrupted(*interrupted_);
    member.slave->exit_initialization();
  }
  drop_inner_connections();
  for (std::size_t i = 0; i < members_.size(); ++i) read_outputs(i, start_ns);
}

void Ensemble::terminate() {
  // Some FMUs write files when they are terminated. Therefore terminates all slaves, even if one of them fails.
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

std::vector<std::string> Ensemble::free_instances() {
  std::vector<std::string> faults;
  for (auto& member : members_) {
    if (auto fault = member.slave->free_instance()) faults.push_back(std::move(*fault));
  }
  return faults;
}

void Ensemble::read_outputs(std::size_t instance, std::int64_t time_ns) {
  MEBOTS_ASSERT(instance < members_.size());
  auto& member = members_[instance];
  auto& outputs = member.outputs;
  if (member.keeps_earlier && time_ns != member.outputs_time_ns) {  // false if outputs are read again at the same time
    member.earlier_reals = outputs.reals.values;
    member.earlier_time_ns = member.outputs_time_ns;
  }
  member.outputs_time_ns = time_ns;
  const auto kinds = member.output_kinds;
  if (kinds == 0) return;
  if ((kinds & bit(ValueKind::real)) != 0) {
    member.slave->get_reals(outputs.reals.references, outputs.reals.values);
    check_finite(member, time_ns);
    if (member.keeps_earlier) read_derivatives(member, time_ns);
  }
  if ((kinds & bit(ValueKind::integer)) != 0)
    member.slave->get_integers(outputs.integers.references, outputs.integers.values);
  if ((kinds & bit(ValueKind::boolean)) != 0)
    member.slave->get_booleans(outputs.booleans.references, outputs.booleans.values);
  if ((kinds & bit(ValueKind::string)) != 0) {
    member.slave->get_strings(outputs.strings.references, outputs.strings.values);
    check_texts(member, time_ns);
  }
  if ((kinds & bit(ValueKind::binary)) != 0)
    member.slave->get_binaries(outputs.binaries.references, outputs.binaries.values);
}

/// Reports an instance that returns invalid UTF-8, once per instance. Connected inputs receive the bytes unchanged; the
/// results contain replacement characters.
void Ensemble::check_texts(Member& member, std::int64_t time_ns) {
  if (member.reported_texts) return;
  const auto& bank = member.outputs.strings;
  const auto bad = std::ranges::find_if_not(bank.values, is_utf8);
  if (bad == bank.values.end()) return;
  member.reported_texts = true;
  const auto text = fmt::format(
      "the text of '{}' at {} s is not UTF-8, which FMI demands; the results have \"{}\" "
      "(U+FFFD for each wrong byte), and connected inputs get the FMU's bytes",
      bank.variables[static_cast<std::size_t>(bad - bank.values.begin())]->name, to_seconds(time_ns),
      one_line(valid_utf8(*bad)));
  messages_->message({member.slave->name(), Severity::warning, "notice", text, time_ns});
}

void Ensemble::check_finite(const Member& member, std::int64_t time_ns) const {
  const auto& bank = member.outputs.reals;
  for (std::size_t i = 0; i < bank.values.size(); ++i) {
    if (std::isfinite(bank.values[i])) continue;
    throw NotFiniteError(fmt::format(
        "instance '{}' at {} s: the variable '{}' is {}; the run cannot continue. Check the inputs and parameters of "
        "'{}', or use a smaller step",
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
  if (member.takes_reals_as_they_are) return;
  move_all(member.integer_copies);
  move_all(member.boolean_copies);
  move_all(member.string_copies);
  move_all(member.binary_copies);
  convert_binaries(member);
  for (const auto& copy : member.flag_copies) *copy.to = *copy.from == 0 ? 0 : 1;
  for (const auto& mapping : member.mappings) {
    const auto value = *mapping.copy.from;
    *mapping.copy.to = in_map(*mapping.map, mapping.kind == ValueKind::boolean && value != 0 ? 1 : value);
  }
  if (!member.conversions.empty()) convert(member);
}

void Ensemble::convert(Member& member) const {
  for (const auto& conversion : member.conversions) {
    MEBOTS_ASSERT(conversion.to < member.inputs.reals.values.size());
    double value = conversion.factor * number(conversion.from) + conversion.offset;
    if (conversion.add) value += member.inputs.reals.values[conversion.to];
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
  auto& member = members_[instance];
  if (member.input_kinds == 0) return;
  member.inputs_time_ns = time_ns;
  collect_inputs(instance);
  if (member.takes_reals_as_they_are) return hand_inputs(instance);
  if (!member.item_checks.empty()) check_items(member, time_ns);
  if (!member.range_checks.empty()) check_ranges(member, time_ns);
  if (!member.derivatives.empty()) start_on_lines(member, time_ns);
  hand_inputs(instance);
  if (!member.derivatives.empty()) write_derivatives(member, time_ns);
}

void Ensemble::check_items(const Member& member, std::int64_t time_ns) const {
  for (const auto& check : member.item_checks) {
    const auto value = member.inputs.integers.values[check.slot];
    if (std::ranges::find(check.items, value) != check.items.end()) continue;
    throw Error(
        fmt::format("instance '{}' at {} s: the input '{}' would be {}, which is not an item of '{}' (it has {}); "
                    "it comes from {}",
                    member.slave->name(), to_seconds(time_ns), check.connection->to.variable->name, value,
                    check.connection->to.variable->declared_type, fmt::join(check.items, ", "),
                    system_->text(check.connection->from)));
  }
}

namespace {

constexpr double kLargestFloat = std::numeric_limits<float>::max();

/// Clamps `value` to the range of an integer type. If `is_unsigned` is true, `value` contains the 64 bits of a UInt64.
std::int64_t nearest_in(Type type, std::int64_t value, bool is_unsigned) {
  const auto [low, high] = fmi::limits_of(type);
  if (is_unsigned || value >= 0) return static_cast<std::int64_t>(std::min(static_cast<std::uint64_t>(value), high));
  return std::max(value, low);
}

}  // namespace

void Ensemble::keep_in_ranges(Member& member) {
  for (const auto& [connection, slot] : member.range_checks) {
    const auto type = connection->to.variable->type;
    if (type == Type::float32) {
      auto& value = member.inputs.reals.values[slot];
      value = std::clamp(value, -kLargestFloat, kLargestFloat);
    } else if (!fmi::is_float(type)) {
      auto& value = member.inputs.integers.values[slot];
      value = nearest_in(type, value, connection->from.variable->type == Type::uint64);
    }
  }
}

void Ensemble::check_ranges(const Member& member, std::int64_t time_ns) const {
  for (const auto& [connection, slot] : member.range_checks) {
    const auto type = connection->to.variable->type;
    const bool is_unsigned = connection->from.variable->type == Type::uint64;
    std::string value;
    if (fmi::is_float(type)) {
      const double real = member.inputs.reals.values[slot];
      if (type == Type::real || std::abs(real) <= kLargestFloat) continue;
      value = fmt::format("{}", real);
    } else {
      const auto whole = member.inputs.integers.values[slot];
      if (nearest_in(type, whole, is_unsigned) == whole) continue;
      value = is_unsigned ? fmt::format("{}", static_cast<std::uint64_t>(whole)) : fmt::format("{}", whole);
    }
    throw Error(
        fmt::format("instance '{}' at {} s: the input '{}' would be {}, which is not in the range of {}; it comes "
                    "from {}",
                    member.slave->name(), to_seconds(time_ns), connection->to.variable->name, value,
                    modeldesc::to_string(type), system_->text(connection->from)));
  }
}

/// Returns the slope of a source's output over the source's last step.
double Ensemble::line_slope(const DerivativeLink& link) const {
  const auto& source = members_[link.from.instance];
  const double length_s = grid_.length_s(source.earlier_time_ns, source.outputs_time_ns);
  return (real(link.from) - source.earlier_reals[link.from.slot]) / length_s;
}

/// Interpolates inputs whose source has already stepped (Gauss-Seidel). The input starts on the line through the
/// source's values at both ends of its last step. If the input were constant at the later value, the method would lose
/// one order.
void Ensemble::start_on_lines(Member& member, std::int64_t time_ns) const {
  for (const auto& link : member.derivatives) {
    const auto& source = members_[link.from.instance];
    if (source.outputs_time_ns <= time_ns) continue;
    const double value =
        source.earlier_reals[link.from.slot] + line_slope(link) * grid_.length_s(source.earlier_time_ns, time_ns);
    member.inputs.reals.values[link.to] = link.connection->factor * value + link.connection->offset;
  }
}

void Ensemble::read_derivatives(Member& member, std::int64_t time_ns) const {
  auto& derivatives = member.output_derivatives;
  if (time_ns == system_->description->start_time_ns) return;  // FMUs have no derivatives before their first step
  member.slave->get_output_derivatives(derivatives.references, derivatives.orders, derivatives.values);
}

/// Writes the derivatives of an input to `values`, starting at order 1. Unknown derivatives are 0. Returns false if no
/// derivative is known.
bool Ensemble::find_derivatives(DerivativeLink& link, std::int64_t time_ns, std::span<double> values) {
  MEBOTS_ASSERT(values.size() == link.orders && link.orders > 0, "link_derivatives() makes no empty ones");
  const auto& source = members_[link.from.instance];
  std::ranges::fill(values, 0);
  if (source.outputs_time_ns > time_ns) {
    values.front() = line_slope(link);
  } else if (source.outputs_time_ns == time_ns) {
    if (time_ns == system_->description->start_time_ns) return false;
    std::ranges::copy(std::span(source.output_derivatives.values).subspan(link.from_first, link.orders),
                      values.begin());
  }
  hold_from_bad(link, time_ns, values);
  for (auto& value : values) value *= link.connection->factor;
  return true;
}

/// Sets the first NaN or infinite derivative and all higher derivatives to 0. FMUs of some tools return NaN.
void Ensemble::hold_from_bad(DerivativeLink& link, std::int64_t time_ns, std::span<double> values) {
  const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (bad == values.end()) return;
  if (!link.nan_reported) {
    const auto text = fmt::format(
        "{} -> {}: the derivative of order {} from the FMU of '{}' is {} at {} s; the input is held constant in such "
        "steps",
        system_->text(link.connection->from), system_->text(link.connection->to), bad - values.begin() + 1,
        members_[link.from.instance].slave->name(), *bad, to_seconds(time_ns));
    messages_->message({{}, Severity::info, "notice", text, time_ns});
    link.nan_reported = true;
  }
  std::fill(bad, values.end(), 0);
}

void Ensemble::write_derivatives(Member& member, std::int64_t time_ns) {
  auto& all = member.input_derivatives;
  bool any = false;
  for (auto& link : member.derivatives) {
    any |= find_derivatives(link, time_ns, std::span(all.values).subspan(link.to_first, link.orders));
  }
  if (any) member.slave->set_input_derivatives(all.references, all.orders, all.values);
}

std::vector<Banks> Ensemble::outputs() const {
  std::vector<Banks> result;
  result.reserve(members_.size());
  for (const auto& member : members_) result.push_back(member.outputs);
  return result;
}

void Ensemble::bring_back(const std::vector<Banks>& outputs) {
  // Copies only values, because observers store addresses of the elements.
  for (std::size_t i = 0; i < members_.size(); ++i) {
    MEBOTS_ASSERT(outputs.size() == members_.size(), "they come from outputs()");
    auto& now = members_[i].outputs;
    MEBOTS_ASSERT(outputs[i].reals.values.size() == now.reals.values.size());
    MEBOTS_ASSERT(outputs[i].strings.values.size() == now.strings.values.size());
    std::ranges::copy(outputs[i].reals.values, now.reals.values.begin());
    std::ranges::copy(outputs[i].integers.values, now.integers.values.begin());
    std::ranges::copy(outputs[i].booleans.values, now.booleans.values.begin());
    std::ranges::copy(outputs[i].strings.values, now.strings.values.begin());
    std::ranges::copy(outputs[i].binaries.values, now.binaries.values.begin());
  }
}

void Ensemble::visit(state::Visitor& v) {
  for (auto& member : members_) {
    const auto& name = member.slave->name();
    v(name + ".reals", std::span(member.outputs.reals.values));
    v(name + ".integers", std::span(member.outputs.integers.values));
    v(name + ".booleans", std::span(member.outputs.booleans.values));
    v(name + ".strings", std::span(member.outputs.strings.values));
    v(name + ".binaries", std::span(member.outputs.binaries.values));
    v(name + ".outputs_time_ns", member.outputs_time_ns);
    v(name + ".earlier_reals", std::span(member.earlier_reals));
    v(name + ".earlier_time_ns", member.earlier_time_ns);
    v(name + ".input_reals", std::span(member.inputs.reals.values));
    v(name + ".input_derivatives", std::span(member.input_derivatives.values));
    v(name + ".inputs_time_ns", member.inputs_time_ns);
  }
}

}  // namespace mebots::master
