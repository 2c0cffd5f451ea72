// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/fmu_archive.hpp"
#include "model.hpp"

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mebots::master::ssp {

/// A connector. `element` is the path of its element, such as "outer.inner"; empty for the root system.
struct Endpoint {
  std::string element;
  std::string connector;

  auto operator<=>(const Endpoint&) const = default;
  std::string text() const { return element.empty() ? connector : element + "." + connector; }
};

/// The declarations of an endpoint in the FMU and in the SSD. The FMU takes precedence.
struct Port {
  const Connector* declared = nullptr;
  const modeldesc::ModelDescription* model = nullptr;  ///< null for a system, or if the FMU cannot be read
  const modeldesc::Variable* variable = nullptr;
  bool is_component = false;

  /// Returns the unit of the FMU if it is defined in base units; otherwise the unit of the SSD.
  std::optional<modeldesc::Unit> unit() const;
  /// True if unit() comes from the FMU, or if there is no unit.
  bool has_own_unit() const;
};

/// A connection from the source to the target of its values.
struct Hop {
  Endpoint from;
  Endpoint to;
  const Connection* connection = nullptr;
};

/// A chain of connections from a source to the variable of a component. If the chain begins at a connector of a system,
/// this connector has no source. If one connection of the chain names an array element, all ends are elements.
using Way = std::vector<Hop>;

/// `way` must connect whole arrays. Returns the part of `way` that connects their elements with the indices `indices`,
/// such as "[2]". Throws InputError if a connection of `way` already names an element.
Way element_of(const Way& way, const std::string& indices);

struct PlacedComponent {
  std::string path;
  const Element* element;
};

/// All elements of a document, and the directions of their connections.
class Network {
 public:
  /// `place` returns the path of an FMU. `root` must outlive the network. Throws InputError if a connection has no
  /// possible direction, or if a target has two sources.
  Network(const Element& root, FmuDescriptions& descriptions,
          const std::function<std::filesystem::path(const std::filesystem::path&)>& place);

  const std::vector<PlacedComponent>& components() const { return components_; }
  /// Returns all elements with their paths. Inner elements precede their containers.
  const std::vector<PlacedComponent>& elements() const { return elements_; }
  Port port(const Endpoint& endpoint) const;
  bool is_component(const std::string& path) const { return models_.contains(path); }
  /// Returns the endpoints of a hierarchical name relative to the element `path` (SSP 2.0, 5.3.3). The result may be
  /// empty or contain several endpoints. If an FMU cannot be read, assumes that it has the variable.
  std::vector<Endpoint> find(const std::string& path, const std::string& name) const;
  /// Returns the indices of an array element, such as "[2]"; empty for a whole connector or variable.
  std::string indices_of(const Endpoint& endpoint) const;
  /// Returns the indices of all elements of an array connector that have a source of their own.
  std::vector<std::string> connected_elements(const Endpoint& array) const;
  /// Returns the connection that ends at the endpoint; null if no connection does.
  const Hop* into(const Endpoint& endpoint) const;
  /// Returns all chains of connections that end at a variable of a component, in the order of the connections. Elements
  /// of a system's array connector may be connected on one side of the system, and the whole array on the other side.
  /// The result then contains the chain of the whole array from this connector, and a chain for each connected element.
  /// Throws InputError for a cycle.
  std::vector<Way> ways() const;

 private:
  enum class Flow { source, target, unknown };

  void add(const Element& element, const std::string& path, FmuDescriptions& descriptions,
           const std::function<std::filesystem::path(const std::filesystem::path&)>& place);
  void direct(const Element& system, const std::string& path);
  Flow flow(const Endpoint& endpoint, bool is_own) const;
  bool has(const Endpoint& endpoint) const;
  const Connector* connector(const Endpoint& endpoint) const;
  void check_elements() const;
  std::optional<Hop> hop_into(const Endpoint& endpoint) const;
  void follow(Way& way) const;

  std::vector<PlacedComponent> components_;
  std::vector<PlacedComponent> elements_;
  std::map<std::string, const modeldesc::ModelDescription*> models_;  // key: path of a component
  std::map<Endpoint, const Connector*> connectors_;
  std::map<Endpoint, Hop> hops_;  // key: end of the connection
  std::vector<Endpoint> order_;   // in the order of the file
};

}  // namespace mebots::master::ssp
