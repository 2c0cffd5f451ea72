// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "definitions_writer.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>
#include <vector>

namespace mebots::master::ssp {

/// One end of a connection, named as in SSP.
struct WrittenEnd {
  std::size_t instance = 0;
  std::string connector;  ///< name of a variable, an array or an OSMP binary
  /// Indices of an array's element, starting at 1 and separated by spaces; empty for the whole connector.
  std::string indices;
};

/// Translates names in connections of a config to SSP connectors, and writes these connectors.
class ConnectorWriter {
 public:
  /// `system` must outlive this object.
  explicit ConnectorWriter(const ResolvedSystem& system);

  /// Returns the SSP connections, as pairs of source and target, that replace a connection of the config. A connection
  /// of two OSMP binaries becomes three, one for each of their Integers. Stores the connectors for write().
  std::vector<std::pair<WrittenEnd, WrittenEnd>> ends(const ConnectionDescription& connection);
  /// Appends the element <Connectors>, which contains the connectors of an instance, sorted by name.
  void write(pugi::xml_node component, std::size_t instance, DefinitionsWriter& definitions) const;

 private:
  /// Stores the variable of a connector: a scalar, one element of an array, or the first Integer of an OSMP binary.
  struct Connector {
    const modeldesc::Variable* variable = nullptr;
    std::string sizes;  // sizes of an array, separated by spaces
    bool is_binary = false;
  };
  using Connectors = std::map<std::string, Connector>;

  /// True if an OSMP binary has this name. Such a binary consists of three Integer variables.
  bool is_osmp(const VariableName& name) const;
  WrittenEnd end_of(const VariableName& name);

  const ResolvedSystem* system_;
  std::vector<Connectors> arrays_;      // indexed by instance
  std::vector<Connectors> connectors_;  // indexed by instance
};

/// Returns the indices in the name of an array's element, such as "2 3" for `m[2,3]`.
std::string indices_of(const modeldesc::Variable& element);

/// Appends a <Dimension> for each size.
void write_dimensions(pugi::xml_node node, const std::string& sizes);

}  // namespace mebots::master::ssp
