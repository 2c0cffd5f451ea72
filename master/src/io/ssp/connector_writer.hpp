// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "definitions_writer.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>
#include <vector>

namespace mebots::master::ssp {

/// An end of a connection as SSP names it.
struct WrittenEnd {
  std::size_t instance = 0;
  std::string connector;  ///< name of a variable, an array or an OSMP binary
  std::string indices;    ///< of the element of an array, from 1, separated by spaces; empty for the whole connector
};

/// Translates names in connections of a config to connectors of SSP, and writes the connectors.
class ConnectorWriter {
 public:
  /// `system` must outlive this object.
  explicit ConnectorWriter(const ResolvedSystem& system);

  /// Returns the ends for a connection of the config: one pair, or three for OSMP binaries at both ends. Notes the
  /// connectors for write().
  std::vector<std::pair<WrittenEnd, WrittenEnd>> ends(const ConnectionDescription& connection);
  /// Appends <Connectors> with the connectors of an instance, in the order of their names.
  void write(pugi::xml_node component, std::size_t instance, DefinitionsWriter& definitions) const;

 private:
  /// The variable of a connector: a scalar, an element of the array, or the first Integer of an OSMP binary.
  struct Connector {
    const modeldesc::Variable* variable = nullptr;
    std::string sizes;  // of an array, separated by spaces
    bool is_binary = false;
  };
  using Connectors = std::map<std::string, Connector>;

  /// True if the name is that of an OSMP binary, which has no variable.
  bool is_osmp(const VariableName& name) const;
  WrittenEnd end_of(const VariableName& name);

  const ResolvedSystem* system_;
  std::vector<Connectors> arrays_;      // by instance
  std::vector<Connectors> connectors_;  // by instance
};

/// Returns the indices in the name of an array's element: "2 3" for `m[2,3]`.
std::string indices_of(const modeldesc::Variable& element);

/// Appends a <Dimension> for each size.
void write_dimensions(pugi::xml_node node, const std::string& sizes);

}  // namespace mebots::master::ssp
