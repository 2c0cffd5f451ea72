// SPDX-License-Identifier: Apache-2.0
#include "network.hpp"

#include "mebots/input_error.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mebots::master::ssp {
namespace {

using modeldesc::Causality;

std::string join(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

/// Returns the variable of this name; for an element of an array such as `y[2]`, the array. Null if the model has
/// neither.
const modeldesc::Variable* named_variable(const modeldesc::ModelDescription& model, const std::string& name) {
  const auto* variable = model.find(name);
  if (variable != nullptr || !name.ends_with(']')) return variable;
  const auto* array = model.find(std::string_view(name).substr(0, name.rfind('[')));
  return array == nullptr || array->fmi3->dimensions.empty() ? nullptr : array;
}

/// Returns the variable of a connector; for an OSMP binary, the first of its three variables.
const modeldesc::Variable* variable_of(const modeldesc::ModelDescription& model, const std::string& connector) {
  const auto* variable = named_variable(model, connector);
  return variable != nullptr ? variable : model.find(connector + kOsmpEndings[0]);
}

/// True if values can only go to the variable. A Clock with its own timing is a source of ticks (SSP 2.0, 5.4.2.1).
bool is_target(const modeldesc::Variable& variable) {
  if (variable.type == modeldesc::Type::clock && variable.fmi3->timing->is_time_based()) return false;
  return variable.causality == Causality::input || variable.causality == Causality::parameter ||
         variable.causality == Causality::structural_parameter;
}

std::string_view kind_text(ConnectorKind kind) {
  switch (kind) {
    case ConnectorKind::input:
      return "input";
    case ConnectorKind::output:
      return "output";
    case ConnectorKind::parameter:
      return "parameter";
    case ConnectorKind::structural_parameter:
      return "structuralParameter";
    case ConnectorKind::calculated_parameter:
      return "calculatedParameter";
    case ConnectorKind::constant:
      return "constant";
    case ConnectorKind::local:
      return "local";
    case ConnectorKind::inout:
      return "inout";
    case ConnectorKind::unspecified:
      break;
  }
  return "unspecified";
}

}  // namespace

bool Port::has_own_unit() const {
  if (variable == nullptr) return declared == nullptr || !declared->unit;
  if (variable->unit.empty()) return declared == nullptr || !declared->unit;
  const auto* defined = model->unit(variable->unit);
  return (defined != nullptr && defined->has_base) || declared == nullptr || !declared->unit;
}

std::optional<modeldesc::Unit> Port::unit() const {
  if (!has_own_unit()) return declared->unit;
  if (variable == nullptr || variable->unit.empty()) return std::nullopt;
  if (const auto* defined = model->unit(variable->unit)) return *defined;
  modeldesc::Unit unit;
  unit.name = variable->unit;
  unit.has_base = false;
  return unit;
}

Network::Network(const Element& root, FmuDescriptions& descriptions,
                 const std::function<std::filesystem::path(const std::filesystem::path&)>& place) {
  add(root, "", descriptions, place);
  for (const auto& [path, element] : elements_) direct(*element, path);
}

void Network::add(const Element& element, const std::string& path, FmuDescriptions& descriptions,
                  const std::function<std::filesystem::path(const std::filesystem::path&)>& place) {
  for (const auto& connector : element.connectors) connectors_.emplace(Endpoint{path, connector.name}, &connector);
  if (element.kind == Element::Kind::component) {
    components_.push_back({path, &element});
    if (!models_.emplace(path, descriptions.find(place(element.fmu))).second) {
      throw InputError(ErrorCode::duplicate_name,
                       fmt::format("{}: two components are called \"{}\" from outside; rename one, or its system",
                                   element.place, path));
    }
  }
  for (const auto& inner : element.elements) add(inner, join(path, inner.name), descriptions, place);
  elements_.push_back({path, &element});
}

Port Network::port(const Endpoint& endpoint) const {
  Port port;
  const auto connector = connectors_.find(endpoint);
  if (connector != connectors_.end()) port.declared = connector->second;
  const auto model = models_.find(endpoint.element);
  if (model == models_.end()) return port;
  port.is_component = true;
  port.model = model->second;
  if (port.model != nullptr) port.variable = variable_of(*port.model, endpoint.connector);
  return port;
}

/// Returns the direction of values at an endpoint. An element's outputs are sources, and its inputs are targets. For
/// connectors of the enclosing system (`is_own`), the direction is reversed (SSP 2.0, 5.4.2.1).
Network::Flow Network::flow(const Endpoint& endpoint, bool is_own) const {
  const auto known = port(endpoint);
  if (known.variable != nullptr) {
    return is_target(*known.variable) ? Flow::target : Flow::source;
  }
  if (known.declared == nullptr) return Flow::unknown;
  switch (known.declared->kind) {
    case ConnectorKind::input:
    case ConnectorKind::parameter:
    case ConnectorKind::structural_parameter:
      return is_own ? Flow::source : Flow::target;
    case ConnectorKind::output:
    case ConnectorKind::calculated_parameter:
    case ConnectorKind::constant:
    case ConnectorKind::local:
      return is_own ? Flow::target : Flow::source;
    case ConnectorKind::inout:
    case ConnectorKind::unspecified:
      break;
  }
  return Flow::unknown;
}

void Network::direct(const Element& system, const std::string& path) {
  for (const auto& connection : system.connections) {
    const auto endpoint = [&](const ConnectionEnd& end) {
      return Endpoint{end.element.empty() ? path : join(path, end.element), end.connector};
    };
    Hop hop{endpoint(connection.start), endpoint(connection.end), &connection};
    for (const auto& [end, whole] : {std::pair(connection.start, hop.from), std::pair(connection.end, hop.to)}) {
      if (!end.has_indices || is_component(whole.element)) continue;
      throw InputError(ErrorCode::not_offered,
                       fmt::format("{}: \"{}\" is an element of a system's connector; connect the whole array, or the "
                                   "components inside the system",
                                   connection.place, whole.text()));
    }
    const auto start = flow(hop.from, connection.start.element.empty());
    const auto end = flow(hop.to, connection.end.element.empty());
    if (start == end && start != Flow::unknown) {
      const auto shown = [&](const Endpoint& one) {
        const auto known = port(one);
        if (known.variable != nullptr) return to_string(known.variable->causality);
        return kind_text(known.declared->kind);
      };
      throw InputError(ErrorCode::invalid_connection,
                       fmt::format("{}: \"{}\" ({}) and \"{}\" ({}) both {} a value here; connect an output with an "
                                   "input, or a system's connector with one of the same kind inside it",
                                   connection.place, hop.from.text(), shown(hop.from), hop.to.text(), shown(hop.to),
                                   start == Flow::source ? "give" : "take"));
    }
    if (start == Flow::target || end == Flow::source) std::swap(hop.from, hop.to);
    const auto [other, added] = hops_.emplace(hop.to, hop);
    if (!added) {
      throw InputError(ErrorCode::invalid_connection,
                       fmt::format("{}: \"{}\" has two sources; the other one is at {}", connection.place,
                                   hop.to.text(), other->second.connection->place));
    }
    order_.push_back(hop.to);
  }
}

bool Network::has(const Endpoint& endpoint) const {
  const auto model = models_.find(endpoint.element);
  if (model == models_.end()) return connectors_.contains(endpoint);
  return model->second == nullptr || named_variable(*model->second, endpoint.connector) != nullptr;
}

std::vector<Endpoint> Network::find(const std::string& path, const std::string& name) const {
  std::vector<Endpoint> found;
  if (Endpoint whole{path, name}; has(whole)) found.push_back(std::move(whole));
  if (is_component(path)) return found;  // names in a component are those of its variables
  for (auto dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
    Endpoint inner{join(path, name.substr(0, dot)), name.substr(dot + 1)};
    if (has(inner)) found.push_back(std::move(inner));
  }
  return found;
}

const Hop* Network::into(const Endpoint& endpoint) const {
  const auto hop = hops_.find(endpoint);
  return hop == hops_.end() ? nullptr : &hop->second;
}

std::vector<Way> Network::ways() const {
  std::vector<Way> ways;
  for (const auto& to : order_) {
    if (!is_component(to.element)) continue;  // a system's connector only passes values through
    Way way;
    std::set<Endpoint> seen;
    for (const auto* hop = into(to); hop != nullptr;
         hop = is_component(hop->from.element) ? nullptr : into(hop->from)) {
      if (!seen.insert(hop->from).second) {
        throw InputError(ErrorCode::invalid_connection,
                         fmt::format("{}: the connection to {} runs in a circle through \"{}\"", hop->connection->place,
                                     to.text(), hop->from.text()));
      }
      way.push_back(hop);
    }
    std::ranges::reverse(way);
    ways.push_back(std::move(way));
  }
  return ways;
}

}  // namespace mebots::master::ssp
