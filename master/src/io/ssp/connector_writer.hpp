// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "definitions_writer.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>
#include <vector>

namespace mebots::master::ssp {

struct WrittenEnd {
  std::size_t instance = 0;
  std::string connector;  ///< name of a variable, an array or an OSMP binary
  /// Indices of an array element, from 1, separated by spaces; empty for the whole connector.
  std::string indices;
};

/// Converts the ends of connections to SSP connectors, and writes the connectors.
class ConnectorWriter {
 public:
  /// `system` must outlive this object.
  explicit ConnectorWriter(const ResolvedSystem& system);

  /// Converts a connection of the config to one or more SSP connections, and returns the source and target of each. A
  /// connection of two OSMP binaries becomes three connections, one for each Integer. Stores the connectors for
  /// write().
  std::vector<std::pair<WrittenEnd, WrittenEnd>> ends(const ConnectionDescription& connection);
  /// Appends <Connectors> with the stored connectors of an instance, sorted by name.
  void write(pugi::xml_node component, std::size_t instance, DefinitionsWriter& definitions) const;

 private:
  /// The variable of a connector: a scalar, an element of an array, or the first Integer of an OSMP binary.
  struct Connector {
    const modeldesc::Variable* variable = nullptr;
    std::string sizes;  // sizes of an array, separated by spaces
    bool is_binary = false;
  };
  using Connectors = std::map<std::string, Connector>;

  /// True if `name` is an OSMP binary, which consists of three Integers.
  bool is_osmp(const VariableName& name) const;
  WrittenEnd end_of(const VariableName& name);

  const ResolvedSystem* system_;
  std::vector<Connectors> arrays_;      // indexed by instance
  std::vector<Connectors> connectors_;  // indexed by instance
};

/// Returns the indices of an array element, such as "2 3" for `m[2,3]`.
std::string indices_of(const modeldesc::Variable& element);

void write_dimensions(pugi::xml_node node, const std::string& sizes);

}  // namespace mebots::master::ssp
