// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// The content of an SSP as plain data: its SSD together with the SSV and SSM files that it refers to. No FMU is
/// read here. Sections are those of SSP 2.0, https://ssp-standard.org.
namespace mebots::master::ssp {

using Json = nlohmann::ordered_json;

/// <Units> and <Enumerations> of one file, by name: they hold in that file only (4.4.1).
struct Definitions {
  std::map<std::string, modeldesc::Unit, std::less<>> units;
  std::map<std::string, std::vector<modeldesc::EnumerationItem>, std::less<>> enumerations;
};

/// LinearTransformation: factor * value + offset, after units were converted (4.5.2.1).
struct Linear {
  double factor = 1;
  double offset = 0;
};

/// BooleanMappingTransformation and the like: values that no entry names stay as they are (4.5.2.2).
struct ValueMap {
  enum class Kind { boolean, integer, enumeration };

  Kind kind = Kind::integer;
  std::vector<std::pair<std::string, std::string>> entries;  ///< source and target, as written
};

/// The change of a value by a connection or a parameter mapping; empty for no change.
struct Transformation {
  std::variant<std::monostate, Linear, ValueMap> what;
  bool convert_units = true;  ///< false: suppressUnitConversion
  std::string place;
};

enum class ConnectorKind {
  input,
  output,
  parameter,
  structural_parameter,
  calculated_parameter,
  constant,
  local,
  inout,
  unspecified,
};

struct Connector {
  std::string name;
  ConnectorKind kind = ConnectorKind::unspecified;
  std::optional<modeldesc::Unit> unit;  ///< without base where the file does not define it
  std::vector<modeldesc::EnumerationItem> items;
  std::string place;
};

/// One end of a connection. `element` is empty for a connector of the enclosing system.
struct ConnectionEnd {
  std::string element;
  std::string connector;
};

/// The order of the ends says nothing about the direction (5.4.2).
struct Connection {
  ConnectionEnd start;
  ConnectionEnd end;
  Transformation transformation;
  std::string description;
  std::string place;
};

/// A value from a parameter binding, after prefix and parameter mapping gave it its name.
struct Parameter {
  std::string name;  ///< relative to the element that has the binding
  Json value;
  std::string problem;  ///< why the value cannot be used; empty when it can
  std::optional<modeldesc::Unit> unit;
  Transformation transformation;
  std::string file;  ///< that holds it, as messages name it
  std::string place;
};

/// A component (an FMU), or a system of further elements.
struct Element {
  enum class Kind { component, system };

  Kind kind = Kind::component;
  std::string name;
  std::string description;
  std::vector<Connector> connectors;
  std::vector<Parameter> parameters;  ///< of all bindings in their order: later ones win
  std::string place;
  // component
  std::filesystem::path fmu;
  bool in_own_process = false;  ///< it was meant to run behind a proxy
  // system
  std::vector<Element> elements;
  std::vector<Connection> connections;
};

}  // namespace mebots::master::ssp
