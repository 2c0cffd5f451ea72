// SPDX-License-Identifier: Apache-2.0
#include "system/connection_check.hpp"

#include "base/interrupt.hpp"
#include "base/time.hpp"
#include "slave/osmp.hpp"
#include "system/picture_size.hpp"

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

/// The FMI types whose every value is also one of `to`: going there loses nothing. Not every Integer is an item of an
/// Enumeration: that is looked at in every step.
bool widens(Type from, Type to) {
  if (to == Type::enumeration) return from == Type::integer;
  if (to == Type::real) return from == Type::integer || from == Type::enumeration || from == Type::boolean;
  return to == Type::integer && (from == Type::enumeration || from == Type::boolean);
}

/// Checks one scalar connection and finds out what is to be done to the value on its way.
class ConnectionCheck {
 public:
  ConnectionCheck(const ResolvedSystem& system, const ConnectionDescription& description,
                  const ResolvedConnection& connection)
      : system_(system),
        description_(description),
        connection_(connection),
        from_(*connection.from.variable),
        to_(*connection.to.variable) {}

  ResolvedConnection run() {
    check_causalities();
    check_types();
    check_units();
    apply_transformation();
    return connection_;
  }

  /// What the user should know about this connection; empty when nothing.
  const std::string& notice() const { return notice_; }

 private:
  std::string names() const {
    return fmt::format("{} -> {}", system_.text(connection_.from), system_.text(connection_.to));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(ErrorCode::invalid_connection, fmt::format("{}: {}: {}", description_.place, names(), what));
  }

  const modeldesc::ModelDescription& model(const ResolvedVariable& variable) const {
    return system_.instances[variable.instance].fmu->description();
  }

  void check_causalities() const {
    if (from_.causality != Causality::output) {
      fail(fmt::format("a connection starts at an output, and '{}' is of causality {}", from_.name,
                       modeldesc::to_string(from_.causality)));
    }
    if (to_.causality != Causality::input) {
      fail(fmt::format("a connection ends at an input, and '{}' is of causality {}", to_.name,
                       modeldesc::to_string(to_.causality)));
    }
  }

  void check_types() {
    if (from_.type != to_.type) {
      const auto from_type = modeldesc::to_string(from_.type);
      const auto to_type = modeldesc::to_string(to_.type);
      if (connection_.pointer || !widens(from_.type, to_.type)) {
        fail(
            fmt::format("the types differ: {} and {}; only Boolean and Enumeration go into an Integer, Integer into an "
                        "Enumeration, and all of these into a Real",
                        from_type, to_type));
      }
      notice_ = fmt::format("{}: {} becomes {}", names(), from_type, to_type);
    } else if (from_.type == Type::enumeration && items(connection_.from) != items(connection_.to)) {
      fail(fmt::format("the enumerations differ: '{}' with {} and '{}' with {}", from_.declared_type,
                       fmt::join(items(connection_.from), ", "), to_.declared_type,
                       fmt::join(items(connection_.to), ", ")));
    }
  }

  std::vector<std::string> items(const ResolvedVariable& end) const {
    std::vector<std::string> result;
    const auto* type = model(end).type_definition(end.variable->declared_type);
    if (type == nullptr) return result;
    for (const auto& item : type->items) result.push_back(fmt::format("{} = {}", item.name, item.value));
    return result;
  }

  /// Rules: a variable without a unit takes and gives numbers as they are. One name without definitions is one
  /// unit. Else both units must be defined, of the same dimension, and values are converted.
  void check_units() {
    if (!description_.convert_units || from_.unit.empty() || to_.unit.empty()) return;
    const auto* from_unit = model(connection_.from).unit(from_.unit);
    const auto* to_unit = model(connection_.to).unit(to_.unit);
    const bool from_known = from_unit != nullptr && from_unit->has_base;
    const bool to_known = to_unit != nullptr && to_unit->has_base;
    constexpr const char* kRemedy = "Connect others, or give factor and offset yourself with \"convert_units\": false";
    if (!from_known || !to_known) {
      if (from_.unit == to_.unit) return;
      fail(fmt::format("the units differ: [{}] and [{}], and {} does not say what [{}] is. {}", from_.unit, to_.unit,
                       model(from_known ? connection_.to : connection_.from).model_name,
                       from_known ? to_.unit : from_.unit, kRemedy));
    }
    if (!modeldesc::same_dimension(*from_unit, *to_unit)) {
      fail(fmt::format("the units differ in dimension: [{}] is {} and [{}] is {}. {}", from_.unit,
                       modeldesc::base_unit_text(*from_unit), to_.unit, modeldesc::base_unit_text(*to_unit), kRemedy));
    }
    const auto conversion =
        modeldesc::unit_conversion(*from_unit, *to_unit, from_.relative_quantity && to_.relative_quantity);
    if (conversion.offset != 0 && from_.relative_quantity != to_.relative_quantity) {
      fail(
          fmt::format("one of them is a difference (relativeQuantity) and the other is not, so [{}] cannot be "
                      "converted to [{}]. {}",
                      from_.unit, to_.unit, kRemedy));
    }
    connection_.factor = conversion.factor;
    connection_.offset = conversion.offset;
    if (!connection_.changes_value()) return;
    notice_ = fmt::format("{}: converted from [{}] to [{}]", names(), from_.unit, to_.unit);
  }

  void apply_transformation() {
    if (description_.factor == 1 && description_.offset == 0) return;
    if (to_.type != Type::real) {
      fail(fmt::format("factor and offset need an input of type Real, and '{}' is of type {}", to_.name,
                       modeldesc::to_string(to_.type)));
    }
    connection_.factor *= description_.factor;
    connection_.offset = connection_.offset * description_.factor + description_.offset;
  }

  const ResolvedSystem& system_;
  const ConnectionDescription& description_;
  ResolvedConnection connection_;
  const Variable& from_;
  const Variable& to_;
  std::string notice_;
};

/// The variables named `name.base.lo`, `name.base.hi` and `name.size`, if all are there.
std::optional<std::vector<ResolvedVariable>> binary_parts(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  if (!instance) return std::nullopt;
  std::vector<ResolvedVariable> parts;
  const auto& model = system.instances[*instance].fmu->description();
  for (const auto* ending : kOsmpEndings) {
    const auto* part = model.find(name.variable + ending);
    if (part == nullptr || part->type != Type::integer) return std::nullopt;
    parts.push_back({*instance, part});
  }
  return parts;
}

bool is_scalar(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  return instance && system.instances[*instance].fmu->description().find(name.variable) != nullptr;
}

/// A buffer is valid until its owner's next step ends. A reader that steps less often than the owner reads
/// at its own step's start, when the buffer is fresh; one that steps more often would read a stale one.
void check_buffer_lives(const ResolvedSystem& system, const ResolvedConnection& connection, const std::string& place) {
  const auto& owner = *system.instances[connection.from.instance].description;
  const auto& reader = *system.instances[connection.to.instance].description;
  if (reader.steps % owner.steps == 0) return;
  throw InputError(
      ErrorCode::invalid_connection,
      fmt::format("{}: {} -> {}: a buffer is valid for one step of its owner, so the step of '{}' ({} s) must be "
                  "a multiple of the step of '{}' ({} s)",
                  place, system.text(connection.from), system.text(connection.to), reader.name,
                  time_text(system.description->step_of(reader)), owner.name,
                  time_text(system.description->step_of(owner))));
}

std::vector<ResolvedConnection> scalars_of(const ResolvedSystem& system, const ConnectionDescription& connection) {
  const bool from_scalar = is_scalar(system, connection.from);
  const bool to_scalar = is_scalar(system, connection.to);
  const auto from_parts = from_scalar ? std::nullopt : binary_parts(system, connection.from);
  const auto to_parts = to_scalar ? std::nullopt : binary_parts(system, connection.to);
  if (from_parts && to_parts) {
    check_picture_sizes(system, connection);
    std::vector<ResolvedConnection> result;
    for (std::size_t i = 0; i < from_parts->size(); ++i) result.push_back({(*from_parts)[i], (*to_parts)[i], true});
    return result;
  }
  if (from_parts || to_parts) {
    const auto& binary = from_parts ? connection.from : connection.to;
    const auto& other = from_parts ? connection.to : connection.from;
    const auto& other_place = connection.place;
    system.find(other, other_place);  // throws when it is unknown
    throw InputError(ErrorCode::invalid_connection, fmt::format("{}: '{}' is a binary variable (OSMP) and '{}' is not",
                                                                connection.place, binary.text(), other.text()));
  }
  const auto from = system.find(connection.from, connection.place + "/from");
  const auto to = system.find(connection.to, connection.place + "/to");
  const auto& from_model = system.instances[from.instance].fmu->description();
  return {{from, to, is_osmp_part(from_model, *from.variable)}};
}

}  // namespace

void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted) {
  std::map<std::pair<std::size_t, const Variable*>, std::pair<ResolvedConnection, std::string>> by_target;
  for (const auto& description : system.description->connections) {
    stop_if_interrupted(interrupted);
    for (const auto& scalar : scalars_of(system, description)) {
      ConnectionCheck check(system, description, scalar);
      const auto connection = check.run();
      if (!check.notice().empty()) system.notices.push_back(check.notice());
      if (connection.pointer) check_buffer_lives(system, connection, description.place);
      const auto [existing, added] = by_target.emplace(std::pair(connection.to.instance, connection.to.variable),
                                                       std::pair(connection, description.place));
      if (!added) {
        throw InputError(
            ErrorCode::invalid_connection,
            fmt::format("{}: the input '{}' has two sources: {} (at {}) and {}; keep one of them", description.place,
                        system.text(connection.to), system.text(existing->second.first.from), existing->second.second,
                        system.text(connection.from)));
      }
    }
  }
  for (const auto& [target, connection] : by_target) system.connections.push_back(connection.first);
}

}  // namespace mebots::master
