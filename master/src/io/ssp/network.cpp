// SPDX-License-Identifier: Apache-2.0
#include "network.hpp"

#include "mebots/input_error.hpp"
#include "mebots/modeldesc/declared_variable.hpp"
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

/// Returns the variable of a connector. For an OSMP binary, returns its first Integer.
const modeldesc::Variable* variable_of(const modeldesc::ModelDescription& model, const std::string& connector) {
  const auto* variable = modeldesc::declared_variable(model, connector);
  return variable != nullptr ? variable : model.find(connector + kOsmpEndings[0]);
}

/// True if the variable can only receive values. A Clock with its own timing is a source of ticks (SSP 2.0, 5.4.2.1).
bool is_target(const modeldesc::Variable& variable) {
  if (variable.type == modeldesc::Type::clock && variable.fmi3->timing->is_time_based()) return false;
  return variable.causality == Causality::input || variable.causality == Causality::parameter ||
         variable.causality == Causality::structural_parameter;
}

Endpoint array_of(const Endpoint& element, const std::string& indices) {
  return {element.element, element.connector.substr(0, element.connector.size() - indices.size())};
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
  check_elements();
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
  port.declared = connector(endpoint);
  const auto model = models_.find(endpoint.element);
  if (model == models_.end()) return port;
  port.is_component = true;
  port.model = model->second;
  if (port.model != nullptr) port.variable = variable_of(*port.model, endpoint.connector);
  return port;
}

/// Returns whether an endpoint is a source or a target. Outputs of an element are sources, and inputs are targets. For
/// connectors of the enclosing system (`is_own`), it is the reverse (SSP 2.0, 5.4.2.1).
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

std::string Network::indices_of(const Endpoint& endpoint) const {
  const auto& name = endpoint.connector;
  if (!name.ends_with(']') || connectors_.contains(endpoint)) return {};
  const auto model = models_.find(endpoint.element);
  if (model != models_.end() && model->second != nullptr && model->second->find(name) != nullptr) return {};
  const auto bracket = name.rfind('[');
  return bracket == std::string::npos ? std::string() : name.substr(bracket);
}

/// Returns the declared connector of an endpoint. For an array element, returns the connector of the array. Returns
/// null if it is not declared.
const Connector* Network::connector(const Endpoint& endpoint) const {
  auto found = connectors_.find(endpoint);
  if (const auto indices = indices_of(endpoint); !indices.empty())
    found = connectors_.find(array_of(endpoint, indices));
  return found == connectors_.end() ? nullptr : found->second;
}

bool Network::has(const Endpoint& endpoint) const {
  const auto model = models_.find(endpoint.element);
  if (model == models_.end()) return connector(endpoint) != nullptr;
  return model->second == nullptr || modeldesc::declared_variable(*model->second, endpoint.connector) != nullptr;
}

std::vector<Endpoint> Network::find(const std::string& path, const std::string& name) const {
  std::vector<Endpoint> found;
  if (Endpoint whole{path, name}; has(whole)) found.push_back(std::move(whole));
  if (is_component(path)) return found;  // a component contains only variables
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

std::vector<std::string> Network::connected_elements(const Endpoint& array) const {
  std::vector<std::string> elements;
  const auto stem = array.connector + "[";
  for (auto hop = hops_.lower_bound({array.element, stem}); hop != hops_.end(); ++hop) {
    const auto& to = hop->first;
    if (to.element != array.element || !to.connector.starts_with(stem)) break;
    if (auto indices = indices_of(to); array_of(to, indices) == array) elements.push_back(std::move(indices));
  }
  return elements;
}

/// Throws InputError if an array connector of a system and one of its elements both have a source.
void Network::check_elements() const {
  for (const auto& [to, hop] : hops_) {
    const auto indices = indices_of(to);
    const auto* whole = indices.empty() || is_component(to.element) ? nullptr : into(array_of(to, indices));
    if (whole == nullptr) continue;
    throw InputError(ErrorCode::invalid_connection,
                     fmt::format("{}: \"{}\" has two sources; the other one is that of the whole array, at {}",
                                 hop.connection->place, to.text(), whole->connection->place));
  }
}

/// Returns the connection into the endpoint. For an element of an array that is connected as a whole, returns the part
/// of this connection for the element.
std::optional<Hop> Network::hop_into(const Endpoint& endpoint) const {
  if (const auto* hop = into(endpoint)) return *hop;
  const auto indices = indices_of(endpoint);
  const auto* whole = indices.empty() ? nullptr : into(array_of(endpoint, indices));
  if (whole == nullptr) return std::nullopt;
  return element_of({*whole}, indices).front();
}

/// Appends connections from the target towards the source, until a component or a connector without a source.
void Network::follow(Way& way) const {
  std::set<Endpoint> seen;
  for (const auto& hop : way) seen.insert(hop.from);
  while (!is_component(way.back().from.element)) {
    auto hop = hop_into(way.back().from);
    if (!hop) return;
    if (!seen.insert(hop->from).second) {
      throw InputError(ErrorCode::invalid_connection,
                       fmt::format("{}: the connection to {} runs in a circle through \"{}\"", hop->connection->place,
                                   way.front().to.text(), hop->from.text()));
    }
    way.push_back(std::move(*hop));
  }
}

std::vector<Way> Network::ways() const {
  std::vector<Way> ways;
  for (const auto& to : order_) {
    if (!is_component(to.element)) continue;  // connectors of systems only forward values
    std::vector<Way> found{{*into(to)}};
    for (std::size_t i = 0; i < found.size(); ++i) {
      auto way = std::move(found[i]);
      follow(way);
      const auto& source = way.back().from;
      const auto elements = is_component(source.element) ? std::vector<std::string>() : connected_elements(source);
      for (const auto& indices : elements) found.push_back(element_of(way, indices));
      std::ranges::reverse(way);
      ways.push_back(std::move(way));
    }
  }
  return ways;
}

Way element_of(const Way& way, const std::string& indices) {
  Way result;
  for (auto hop : way) {
    if (hop.connection->start.has_indices || hop.connection->end.has_indices) {
      throw InputError(ErrorCode::invalid_connection,
                       fmt::format("{}: this connects an element of an array with \"{}\", which is an array elsewhere; "
                                   "connect elements with elements, or whole arrays",
                                   hop.connection->place, hop.from.text()));
    }
    hop.from.connector += indices;
    hop.to.connector += indices;
    result.push_back(std::move(hop));
  }
  return result;
}

}  // namespace mebots::master::ssp
