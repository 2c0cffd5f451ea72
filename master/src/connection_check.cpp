// SPDX-License-Identifier: Apache-2.0
#include "connection_check.hpp"

#include "mebots/master/time.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variable;

/// Checks one scalar connection.
class ConnectionCheck {
 public:
  ConnectionCheck(const ResolvedSystem& system, const ResolvedConnection& connection, const std::string& place)
      : system_(system), from_(connection.from), to_(connection.to), place_(place) {}

  void run() const {
    check_causalities();
    check_types();
    check_units();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {} -> {}: {}", place_, system_.text(from_), system_.text(to_), what));
  }

  const modeldesc::ModelDescription& model(const ResolvedVariable& variable) const {
    return system_.instances[variable.instance].fmu->description();
  }

  void check_causalities() const {
    const auto name = [](const ResolvedVariable& end) { return modeldesc::to_string(end.variable->causality); };
    if (from_.variable->causality != Causality::output) {
      fail(fmt::format("a connection starts at an output, and '{}' is of causality {}", from_.variable->name,
                       name(from_)));
    }
    if (to_.variable->causality != Causality::input) {
      fail(fmt::format("a connection ends at an input, and '{}' is of causality {}", to_.variable->name, name(to_)));
    }
  }

  void check_types() const {
    const auto& from = *from_.variable;
    const auto& to = *to_.variable;
    if (from.type != to.type) {
      fail(fmt::format("the types differ: {} and {}", modeldesc::to_string(from.type), modeldesc::to_string(to.type)));
    }
    if (from.type == Type::enumeration && items(from_) != items(to_)) {
      fail(fmt::format("the enumerations differ: '{}' with {} and '{}' with {}", from.declared_type,
                       fmt::join(items(from_), ", "), to.declared_type, fmt::join(items(to_), ", ")));
    }
  }

  std::vector<std::string> items(const ResolvedVariable& end) const {
    std::vector<std::string> result;
    const auto* type = model(end).type_definition(end.variable->declared_type);
    if (type == nullptr) return result;
    for (const auto& item : type->items) result.push_back(fmt::format("{} = {}", item.name, item.value));
    return result;
  }

  void check_units() const {
    const auto& from = *from_.variable;
    const auto& to = *to_.variable;
    if (from.unit.empty() || to.unit.empty() || from.unit == to.unit) return;
    const auto* from_unit = model(from_).unit(from.unit);
    const auto* to_unit = model(to_).unit(to.unit);
    const bool known = from_unit != nullptr && to_unit != nullptr && from_unit->has_base && to_unit->has_base;
    if (known && modeldesc::same_unit(*from_unit, *to_unit)) return;  // two names of one unit
    fail(fmt::format("the units differ: [{}] and [{}]", from.unit, to.unit));
  }

  const ResolvedSystem& system_;
  ResolvedVariable from_;
  ResolvedVariable to_;
  const std::string& place_;
};

/// The variables named `name.base.lo`, `name.base.hi` and `name.size`, if all are there.
std::optional<std::vector<ResolvedVariable>> binary_parts(const ResolvedSystem& system, const VariableName& name) {
  std::vector<ResolvedVariable> parts;
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    if (system.instances[i].description->name != name.instance) continue;
    const auto& model = system.instances[i].fmu->description();
    for (const auto* ending : kOsmpEndings) {
      const auto* part = model.find(name.variable + ending);
      if (part == nullptr || part->type != Type::integer) return std::nullopt;
      parts.push_back({i, part});
    }
  }
  if (parts.size() != std::size(kOsmpEndings)) return std::nullopt;
  return parts;
}

bool is_scalar(const ResolvedSystem& system, const VariableName& name) {
  return std::any_of(system.instances.begin(), system.instances.end(), [&](const ResolvedInstance& instance) {
    return instance.description->name == name.instance && instance.fmu->description().find(name.variable) != nullptr;
  });
}

/// A buffer is valid until its owner's next step ends. A reader that steps less often than the owner reads
/// at its own step's start, when the buffer is fresh; one that steps more often would read a stale one.
void check_buffer_lives(const ResolvedSystem& system, const ResolvedConnection& connection, const std::string& place) {
  const auto& owner = *system.instances[connection.from.instance].description;
  const auto& reader = *system.instances[connection.to.instance].description;
  if (reader.step_ns % owner.step_ns == 0) return;
  throw InputError(
      fmt::format("{}: {} -> {}: a buffer is valid for one step of its owner, so the step of '{}' ({} s) must be "
                  "a multiple of the step of '{}' ({} s)",
                  place, system.text(connection.from), system.text(connection.to), reader.name,
                  to_seconds(reader.step_ns), owner.name, to_seconds(owner.step_ns)));
}

std::vector<ResolvedConnection> scalars_of(const ResolvedSystem& system, const ConnectionDescription& connection) {
  const bool from_scalar = is_scalar(system, connection.from);
  const bool to_scalar = is_scalar(system, connection.to);
  const auto from_parts = from_scalar ? std::nullopt : binary_parts(system, connection.from);
  const auto to_parts = to_scalar ? std::nullopt : binary_parts(system, connection.to);
  if (from_parts && to_parts) {
    std::vector<ResolvedConnection> result;
    for (std::size_t i = 0; i < from_parts->size(); ++i) result.push_back({(*from_parts)[i], (*to_parts)[i], true});
    return result;
  }
  if (from_parts || to_parts) {
    const auto& binary = from_parts ? connection.from : connection.to;
    const auto& other = from_parts ? connection.to : connection.from;
    const auto& other_place = connection.place;
    system.find(other, other_place);  // throws when it is unknown
    throw InputError(fmt::format("{}: '{}' is a binary variable (OSMP) and '{}' is not", connection.place,
                                 binary.text(), other.text()));
  }
  const auto from = system.find(connection.from, connection.place + "/from");
  const auto to = system.find(connection.to, connection.place + "/to");
  const auto& from_model = system.instances[from.instance].fmu->description();
  return {{from, to, is_osmp_part(from_model, *from.variable)}};
}

}  // namespace

void resolve_connections(ResolvedSystem& system) {
  std::map<std::pair<std::size_t, const Variable*>, std::pair<ResolvedConnection, std::string>> by_target;
  for (const auto& description : system.description->connections) {
    for (const auto& connection : scalars_of(system, description)) {
      ConnectionCheck(system, connection, description.place).run();
      if (connection.pointer) check_buffer_lives(system, connection, description.place);
      const auto [existing, added] = by_target.emplace(std::pair(connection.to.instance, connection.to.variable),
                                                       std::pair(connection, description.place));
      if (!added) {
        throw InputError(fmt::format("{}: the input '{}' has two sources: {} (at {}) and {}; keep one of them",
                                     description.place, system.text(connection.to),
                                     system.text(existing->second.first.from), existing->second.second,
                                     system.text(connection.from)));
      }
    }
  }
  for (const auto& [target, connection] : by_target) system.connections.push_back(connection.first);
}

}  // namespace mebots::master
