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
  std::string fmu_kind;         ///< as a config spells it; empty = any
  // system
  std::vector<Element> elements;
  std::vector<Connection> connections;
};

/// The change of a value along its way: factor * value + offset, or a map.
class Course {
 public:
  /// `unit`: of the value at the start; nothing where it has none. `difference`: of two values (relativeQuantity), so
  /// that a unit's offset falls out.
  explicit Course(std::optional<modeldesc::Unit> unit, bool difference = false)
      : unit_(std::move(unit)), difference_(difference) {}

  /// Appends a hop to a connector with this unit, or with none: converts units first, then transforms the value
  /// (SSP 2.0, 4.5.2.1). Throws InputError that names the transformation's place.
  void pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit);

  double factor() const { return factor_; }
  double offset() const { return offset_; }
  const std::optional<ValueMap>& map() const { return map_; }
  const std::optional<modeldesc::Unit>& unit() const { return unit_; }
  bool converts_units() const { return converts_units_; }
  /// True if a conversion of units has an offset, as from Celsius to kelvin.
  bool shifts_units() const { return shifts_units_; }
  /// Returns the changed value. Throws InputError that begins with `name` if the value cannot be changed
  /// this way.
  Json apply(const Json& value, const std::string& name) const;

 private:
  void convert(const std::optional<modeldesc::Unit>& unit, const std::string& place);
  void transform(const Linear& linear, const std::string& place);
  void transform(const ValueMap& map, const std::string& place);
  void check_range(const std::string& place) const;

  std::optional<modeldesc::Unit> unit_;
  bool difference_;
  bool converts_units_ = false;
  bool shifts_units_ = false;
  double factor_ = 1;
  double offset_ = 0;
  std::optional<ValueMap> map_;
};

}  // namespace mebots::master::ssp
