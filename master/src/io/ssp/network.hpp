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

/// A connector. `element` is the path of its element, such as "outer.inner"; it is empty for the root system.
struct Endpoint {
  std::string element;
  std::string connector;

  auto operator<=>(const Endpoint&) const = default;
  std::string text() const { return element.empty() ? connector : element + "." + connector; }
};

/// The declarations of an endpoint. The FMU's variable takes precedence over the SSD's connector.
struct Port {
  const Connector* declared = nullptr;
  const modeldesc::ModelDescription* model = nullptr;  ///< null for a system, and if the FMU cannot be read
  const modeldesc::Variable* variable = nullptr;
  bool is_component = false;

  /// Returns the unit of the FMU if it has a definition in base units; else the unit that the SSD declares.
  std::optional<modeldesc::Unit> unit() const;
  /// True if unit() comes from the FMU, or if neither FMU nor SSD declares a unit.
  bool has_own_unit() const;
};

/// A connection in the direction of its values.
struct Hop {
  Endpoint from;
  Endpoint to;
  const Connection* connection = nullptr;
};

/// A chain of connections (hops) from a source to a component's variable, in the direction of the values. If the chain
/// begins at a system's connector, it has no source. If one connection of the chain names an element of an array, all
/// ends of the chain are elements.
using Way = std::vector<Hop>;

/// Returns the chain for the element with these indices, such as "[2]", of the array that the whole chain connects.
/// Throws InputError if a connection of the chain already names an element.
Way element_of(const Way& way, const std::string& indices);

/// A component and its path.
struct PlacedComponent {
  std::string path;
  const Element* element;
};

/// All elements of a document in one list, with the directions of values between their connectors.
class Network {
 public:
  /// `place` returns the path of an FMU. Throws InputError if no direction of a connection is possible, or if a target
  /// has two sources. `root` must outlive the network.
  Network(const Element& root, FmuDescriptions& descriptions,
          const std::function<std::filesystem::path(const std::filesystem::path&)>& place);

  const std::vector<PlacedComponent>& components() const { return components_; }
  /// Returns the elements with their paths; inner elements precede their containers.
  const std::vector<PlacedComponent>& elements() const { return elements_; }
  Port port(const Endpoint& endpoint) const;
  bool is_component(const std::string& path) const { return models_.contains(path); }
  /// Returns the endpoints of a hierarchical name, relative to the element at `path` (SSP 2.0, 5.3.3). A name may have
  /// no endpoint, one or several. If an FMU cannot be read, assumes that it has every variable.
  std::vector<Endpoint> find(const std::string& path, const std::string& name) const;
  /// Returns the indices of an array's element, such as "[2]"; empty for a whole connector or variable.
  std::string indices_of(const Endpoint& endpoint) const;
  /// Returns the indices of the elements of a system's array connector that have a source each.
  std::vector<std::string> connected_elements(const Endpoint& array) const;
  /// Returns the hop that ends at the endpoint; null if no hop ends there.
  const Hop* into(const Endpoint& endpoint) const;
  /// Returns the chains of connections to all components' variables, in the order of the connections. Elements of a
  /// system's array connector may be connected on one side of the system, and the whole array on the other side. Then
  /// the result contains the chain of the whole array, which begins at this connector, and a chain for each connected
  /// element. Throws InputError for a cycle.
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
  std::map<std::string, const modeldesc::ModelDescription*> models_;  // of components
  std::map<Endpoint, const Connector*> connectors_;
  std::map<Endpoint, Hop> hops_;  // by their ends
  std::vector<Endpoint> order_;   // of the connections in the file
};

}  // namespace mebots::master::ssp
