// SPDX-License-Identifier: Apache-2.0
#include "resolve/signal_coverage.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "model/picture_size.hpp"
#include "model/unit_rule.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variable;

/// Returns the range in which a floating-point type represents all whole numbers: up to 2^53 or 2^24.
fmi::WholeLimits exact_range(Type type) {
  constexpr std::int64_t kExactInDouble = std::int64_t{1} << 53;
  constexpr std::int64_t kExactInFloat = std::int64_t{1} << 24;
  const auto most = type == Type::float32 ? kExactInFloat : kExactInDouble;
  return {-most, static_cast<std::uint64_t>(most)};
}

/// Returns the range of a variable whose values are whole numbers: 0 to 1 for a Boolean, the lowest to the highest item
/// for an enumeration, otherwise the range of its type.
fmi::WholeLimits range_of(const modeldesc::ModelDescription& model, const Variable& variable) {
  if (variable.type == Type::boolean) return {0, 1};
  const auto* type = variable.type == Type::enumeration ? model.type_definition(variable.declared_type) : nullptr;
  if (type == nullptr || type->items.empty()) return fmi::limits_of(variable.type);
  const auto [low, high] = std::ranges::minmax(type->items, {}, &modeldesc::EnumerationItem::value);
  return {low.value, static_cast<std::uint64_t>(std::max<std::int64_t>(high.value, 0))};
}

bool is_within(const fmi::WholeLimits& inner, const fmi::WholeLimits& outer) {
  return inner.low >= outer.low && inner.high <= outer.high;
}

/// Checks a scalar connection and determines the conversion of its value.
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
    check_clocks();
    check_causalities();
    check_types();
    check_narrow();
    check_units();
    apply_transformation();
    return connection_;
  }

  /// Returns a notice about the conversion for the user; an empty text if the value is not converted.
  const std::string& notice() const { return notice_; }

 private:
  std::string names() const {
    return fmt::format("{} -> {}", system_.text(connection_.from), system_.text(connection_.to));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(ErrorCode::invalid_connection, fmt::format("{}: {}: {}", description_.place, names(), what));
  }

  const modeldesc::ModelDescription& model(const ResolvedVariable& variable) const {
    return *system_.instances[variable.instance].model;
  }

  FmuKind kind(const ResolvedVariable& variable) const { return system_.instances[variable.instance].kind; }

  void check_clocks() const {
    for (const auto* end : {&connection_.from, &connection_.to}) {
      const auto& variable = *end->variable;
      if (!is_clocked(variable) || system_.instances[end->instance].clocks_tick) continue;
      fail(
          fmt::format("'{}' {}, and clocks tick only in FMUs that have a Clock as an input or output, and "
                      "hasEventMode = true for co-simulation",
                      variable.name, variable.type == Type::clock ? "is a Clock" : "belongs to a Clock"));
    }
    if (is_clocked(from_) && is_clocked(to_) && kind(connection_.from) != kind(connection_.to)) {
      fail(
          "ticks do not pass between model exchange and co-simulation; set \"kind\" so that both instances have the "
          "same kind");
    }
    if (from_.type != Type::clock && to_.type != Type::clock) return;
    if (from_.type != to_.type) {
      fail(fmt::format("'{}' is a Clock and '{}' is not; connect Clocks with each other",
                       from_.type == Type::clock ? from_.name : to_.name,
                       from_.type == Type::clock ? to_.name : from_.name));
    }
    if (to_.fmi3->timing->is_time_based()) {
      fail(fmt::format("'{}' has its own timing and accepts no ticks; connect a triggered Clock", to_.name));
    }
    if (from_.fmi3->element || to_.fmi3->element) fail("arrays of Clocks are not supported");
  }

  /// True for an output, and for an input clock with its own timing.
  bool is_source() const {
    return from_.causality == Causality::output ||
           (from_.type == Type::clock && from_.causality == Causality::input && from_.fmi3->timing->is_time_based());
  }

  void check_causalities() const {
    if (!is_source()) {
      fail(fmt::format("a connection must start at an output, but '{}' has causality {}", from_.name,
                       modeldesc::to_string(from_.causality)));
    }
    if (to_.causality != Causality::input) {
      fail(fmt::format("a connection must end at an input, but '{}' has causality {}", to_.name,
                       modeldesc::to_string(to_.causality)));
    }
  }

  void check_narrow() const {
    if (!description_.narrow || connection_.narrows) return;
    if (!description_.map.empty()) {
      fail("\"narrow\" has no effect on a connection with a \"map\", whose values are checked. Remove \"narrow\"");
    }
    fail("\"narrow\" has no effect, because the input's type has all values of the output's type. Remove \"narrow\"");
  }

  void check_types() {
    if (connection_.converts) return;
    if (!description_.map.empty()) {
      read_map();
    } else if (from_.type != to_.type) {
      const auto from_type = modeldesc::to_string(from_.type);
      const auto to_type = modeldesc::to_string(to_.type);
      const bool is_wider = !connection_.pointer && widens();
      connection_.narrows = !is_wider && description_.narrow && can_narrow();
      if (!is_wider && !connection_.narrows) {
        fail(fmt::format(
            "the types differ: {} and {}; the input's type must have every value of the output's type: Boolean and "
            "Enumeration connect to Integer, Integer to Enumeration, and all of these to Real{}",
            from_type, to_type,
            can_narrow()
                ? ". \"narrow\": true rounds to the nearest value of the input's type, and ends the run at a value "
                  "out of its range"
                : ""));
      }
      notice_ = fmt::format("{}: {} becomes {}", names(), from_type, to_type);
    } else if (from_.type == Type::enumeration && items(connection_.from) != items(connection_.to)) {
      fail(fmt::format("the enumerations differ: '{}' with {} and '{}' with {}", from_.declared_type,
                       fmt::join(items(connection_.from), ", "), to_.declared_type,
                       fmt::join(items(connection_.to), ", ")));
    }
  }

  /// True if the input's type includes all values of the output's type. If the input is an Enumeration, a value may
  /// still not be the number of an item. Ensemble checks this at every step.
  bool widens() const {
    const bool from_whole = fmi::is_whole(from_.type) || from_.type == Type::boolean;
    if (fmi::is_float(to_.type)) {
      if (fmi::is_float(from_.type)) return to_.type == Type::real;
      return from_whole && is_within(range_of(model(connection_.from), from_), exact_range(to_.type));
    }
    if (!from_whole || !fmi::is_whole(to_.type)) return false;
    if (to_.type == Type::enumeration) return fmi::is_whole(from_.type);
    return is_within(range_of(model(connection_.from), from_), fmi::limits_of(to_.type));
  }

  /// True if `"narrow": true` in the config permits this connection although the input's type does not include all
  /// values of the output's type. Each value must then be checked, which is not possible for clocked variables and for
  /// connections of two model exchange instances.
  bool can_narrow() const {
    if (connection_.pointer || is_clocked(from_) || is_clocked(to_)) return false;
    if (kind(connection_.from) == FmuKind::model_exchange && kind(connection_.to) == FmuKind::model_exchange) {
      return false;
    }
    if (fmi::is_float(to_.type))
      return from_.type != Type::uint64 && (fmi::is_float(from_.type) || fmi::is_whole(from_.type));
    return fmi::is_whole(from_.type) && fmi::is_whole(to_.type) && to_.type != Type::enumeration;
  }

  void read_map() {
    const bool flags = from_.type == Type::boolean && to_.type == Type::boolean;
    if (connection_.pointer || (!flags && !(fmi::is_whole(from_.type) && fmi::is_whole(to_.type)))) {
      fail(fmt::format("a map needs two Booleans, or Integers and Enumerations, but these are {} and {}",
                       modeldesc::to_string(from_.type), modeldesc::to_string(to_.type)));
    }
    for (const auto& entry : description_.map) {
      const ValuePair pair{number(typed_value(model(connection_.from), from_, UntypedText{entry.from}, entry.place)),
                           number(typed_value(model(connection_.to), to_, entry.to, entry.place))};
      const auto at = std::ranges::lower_bound(connection_.map, pair.from, {}, &ValuePair::from);
      if (at != connection_.map.end() && at->from == pair.from) {
        throw InputError(ErrorCode::duplicate_name,
                         fmt::format("{}: the map has two values for {}", entry.place, entry.from));
      }
      connection_.map.insert(at, pair);
    }
  }

  static std::int64_t number(const modeldesc::Value& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? 1 : 0;
    return std::get<std::int64_t>(value);
  }

  std::vector<std::string> items(const ResolvedVariable& end) const {
    std::vector<std::string> result;
    const auto* type = model(end).type_definition(end.variable->declared_type);
    if (type == nullptr) return result;
    for (const auto& item : type->items) result.push_back(fmt::format("{} = {}", item.name, item.value));
    return result;
  }

  /// Returns the unit of a variable, with the FMU's definition if it has one.
  modeldesc::Unit unit_of(const ResolvedVariable& variable) const {
    const auto& name = variable.variable->unit;
    if (const auto* defined = model(variable).unit(name)) return *defined;
    modeldesc::Unit unit;
    unit.name = name;
    unit.has_base = false;
    return unit;
  }

  /// Checks the units of both ends and determines their conversion.
  void check_units() {
    if (!description_.convert_units || from_.unit.empty() || to_.unit.empty()) return;
    constexpr const char* kRemedy =
        "Connect other variables, or set factor and offset together with \"convert_units\": false";
    modeldesc::UnitConversion conversion;
    try {
      conversion = conversion_between(unit_of(connection_.from), unit_of(connection_.to),
                                      from_.relative_quantity && to_.relative_quantity);
    } catch (const Error& error) {
      fail(fmt::format("{}. {}", error.what(), kRemedy));
    }
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
    connection_.sum = description_.sum;
    if (description_.sum && !fmi::is_float(to_.type)) {
      fail(fmt::format("a sum needs an input of type Real, but '{}' is of type {}", to_.name,
                       modeldesc::to_string(to_.type)));
    }
    if (description_.sum && is_clocked(from_) && is_clocked(to_)) {
      fail(
          fmt::format("a sum is formed at communication points, but '{}' and '{}' belong to Clocks, and ticks pass "
                      "their values; connect one source without \"sum\"",
                      from_.name, to_.name));
    }
    if (description_.factor == 1 && description_.offset == 0) return;
    if (!fmi::is_float(to_.type)) {
      fail(fmt::format("factor and offset need an input of type Real, but '{}' is of type {}", to_.name,
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

/// Returns the variables `name.base.lo`, `name.base.hi` and `name.size`; nullopt if one of them does not exist.
std::optional<std::vector<ResolvedVariable>> binary_parts(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  if (!instance) return std::nullopt;
  std::vector<ResolvedVariable> parts;
  const auto& model = *system.instances[*instance].model;
  for (const auto* ending : kOsmpEndings) {
    const auto* part = model.find(name.variable + ending);
    if (part == nullptr || part->type != Type::integer) return std::nullopt;
    parts.push_back({*instance, part});
  }
  return parts;
}

bool is_scalar(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  return instance && system.instances[*instance].model->find(name.variable) != nullptr;
}

/// Throws InputError unless the step of the reader is a multiple of the owner's step. A buffer is valid until the end
/// of the owner's next step, and the reader reads it at the start of the reader's step.
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

ResolvedConnection plain_connection(const ResolvedVariable& from, const ResolvedVariable& to, bool pointer) {
  ResolvedConnection connection;
  connection.from = from;
  connection.to = to;
  connection.pointer = pointer;
  return connection;
}

/// Returns the elements of an array in row-major order; an empty list if the name is not an array.
std::vector<ResolvedVariable> elements_of(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  if (!instance) return {};
  std::vector<ResolvedVariable> elements;
  for (const auto& variable : system.instances[*instance].model->variables) {
    if (variable.fmi3->element && variable.fmi3->element->array == name.variable) {
      elements.push_back({*instance, &variable});
    }
  }
  return elements;
}

/// Returns the indices of an array element, such as "[3]" for `y[3]`.
std::string_view indices_of(const ResolvedVariable& element) {
  return std::string_view(element.variable->name).substr(element.variable->fmi3->element->array.size());
}

/// Returns the connections of the elements of two arrays; an empty list if neither name is an array.
std::vector<ResolvedConnection> array_connections(const ResolvedSystem& system,
                                                  const ConnectionDescription& connection) {
  const auto from = elements_of(system, connection.from);
  const auto to = elements_of(system, connection.to);
  if (from.empty() && to.empty()) return {};
  const bool same = std::ranges::equal(from, to, {}, indices_of, indices_of);
  if (!same) {
    const auto shape = [](const std::vector<ResolvedVariable>& elements) {
      return elements.empty() ? std::string("a scalar or unknown")
                              : fmt::format("an array up to {}", indices_of(elements.back()));
    };
    throw InputError(
        ErrorCode::invalid_connection,
        fmt::format("{}: {} is {}, but {} is {}; connect arrays of the same sizes, or single elements such "
                    "as '{}[1]'",
                    connection.place, connection.from.text(), shape(from), connection.to.text(), shape(to),
                    (from.empty() ? connection.to : connection.from).text()));
  }
  std::vector<ResolvedConnection> result;
  for (std::size_t i = 0; i < from.size(); ++i) result.push_back(plain_connection(from[i], to[i], false));
  return result;
}

/// Returns the connections of a Binary with an OSMP binary; an empty list for any other pair.
std::vector<ResolvedConnection> converted(const ResolvedSystem& system, const ConnectionDescription& connection,
                                          const std::optional<std::vector<ResolvedVariable>>& from_parts,
                                          const std::optional<std::vector<ResolvedVariable>>& to_parts) {
  const auto is_binary = [](const ResolvedVariable& variable) { return variable.variable->type == Type::binary; };
  std::vector<ResolvedConnection> result;
  if (from_parts && !to_parts) {
    const auto to = system.find(connection.to, connection.place);
    if (is_binary(to)) result.push_back(plain_connection(from_parts->front(), to, true));
  } else if (to_parts && !from_parts) {
    const auto from = system.find(connection.from, connection.place);
    if (!is_binary(from)) return {};
    for (const auto& part : *to_parts) result.push_back(plain_connection(from, part, false));
  }
  for (auto& one : result) one.converts = true;
  if (!result.empty()) check_picture_sizes(system, connection);
  return result;
}

std::vector<ResolvedConnection> scalars_of(const ResolvedSystem& system, const ConnectionDescription& connection) {
  if (auto elements = array_connections(system, connection); !elements.empty()) return elements;
  const bool from_scalar = is_scalar(system, connection.from);
  const bool to_scalar = is_scalar(system, connection.to);
  const auto from_parts = from_scalar ? std::nullopt : binary_parts(system, connection.from);
  const auto to_parts = to_scalar ? std::nullopt : binary_parts(system, connection.to);
  if (from_parts && to_parts) {
    check_picture_sizes(system, connection);
    std::vector<ResolvedConnection> result;
    for (std::size_t i = 0; i < from_parts->size(); ++i) {
      result.push_back(plain_connection((*from_parts)[i], (*to_parts)[i], true));
    }
    return result;
  }
  if (auto connections = converted(system, connection, from_parts, to_parts); !connections.empty()) return connections;
  if (from_parts || to_parts) {
    const auto& binary = from_parts ? connection.from : connection.to;
    const auto& other = from_parts ? connection.to : connection.from;
    const auto& other_place = connection.place;
    system.find(other, other_place);  // throws if the variable is unknown
    throw InputError(ErrorCode::invalid_connection,
                     fmt::format("{}: '{}' is a binary variable (OSMP) and '{}' is not; connect two binary variables",
                                 connection.place, binary.text(), other.text()));
  }
  const auto from = system.find(connection.from, connection.place + "/from");
  const auto to = system.find(connection.to, connection.place + "/to");
  const auto& from_model = *system.instances[from.instance].model;
  return {plain_connection(from, to, is_osmp_part(from_model, *from.variable))};
}

}  // namespace

namespace {

/// Returns the key for sorting connections, so that their order in the config has no effect: the target and, for the
/// terms of a sum, source, factor and offset.
auto order_of(const ResolvedConnection& connection) {
  return std::tuple(connection.to.instance, connection.to.variable, connection.from.instance, connection.from.variable,
                    connection.factor, connection.offset);
}

struct PlacedConnection {
  ResolvedConnection connection;
  const ConnectionDescription* description;
};

void check_sources(const ResolvedSystem& system, const std::vector<PlacedConnection>& connections) {
  for (std::size_t i = 1; i < connections.size(); ++i) {
    const auto& one = connections[i - 1];
    const auto& other = connections[i];
    if (one.connection.to != other.connection.to || (one.connection.sum && other.connection.sum)) continue;
    const auto& [first, second] = std::minmax(one, other, [](const auto& a, const auto& b) {
      return a.description < b.description;  // both point into the same list
    });
    throw InputError(
        ErrorCode::invalid_connection,
        fmt::format("{}: the input '{}' has two sources: {} (at {}) and {}; keep one of them, or give each "
                    "\"sum\": true for their sum",
                    second.description->place, system.text(second.connection.to), system.text(first.connection.from),
                    first.description->place, system.text(second.connection.from)));
  }
}

}  // namespace

void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted) {
  std::vector<PlacedConnection> connections;
  for (const auto& description : system.description->connections) {
    stop_if_interrupted(interrupted);
    for (const auto& scalar : scalars_of(system, description)) {
      ConnectionCheck check(system, description, scalar);
      const auto connection = check.run();
      if (!check.notice().empty()) system.notices.push_back(check.notice());
      if (connection.pointer) check_buffer_lives(system, connection, description.place);
      connections.push_back({connection, &description});
    }
  }
  std::ranges::stable_sort(connections, {}, [](const auto& placed) { return order_of(placed.connection); });
  check_sources(system, connections);
  for (auto& placed : connections) system.connections.push_back(std::move(placed.connection));
}

}  // namespace mebots::master
