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

/// Declares the content of an SSP: the SSD, and the SSV and SSM files to which it refers. Section numbers refer to SSP
/// 2.0, https://ssp-standard.org.
namespace mebots::master::ssp {

using Json = nlohmann::ordered_json;

/// The <Units> and <Enumerations> of a file. They are valid only in this file (4.4.1).
struct Definitions {
  std::map<std::string, modeldesc::Unit, std::less<>> units;
  std::map<std::string, std::vector<modeldesc::EnumerationItem>, std::less<>> enumerations;
};

/// An SSP LinearTransformation: factor * value + offset, after the conversion of units (4.5.2.1).
struct Linear {
  double factor = 1;
  double offset = 0;
};

/// An SSP BooleanMappingTransformation, IntegerMappingTransformation or EnumerationMappingTransformation. A value
/// without an entry does not change (4.5.2.2).
struct ValueMap {
  enum class Kind { boolean, integer, enumeration };

  Kind kind = Kind::integer;
  std::vector<std::pair<std::string, std::string>> entries;  ///< pairs of source and target as in the file
};

/// The transformation of a connection or parameter mapping. `what` is empty if the element has none.
struct Transformation {
  std::variant<std::monostate, Linear, ValueMap> what;
  bool convert_units = true;  ///< false: the element has the attribute suppressUnitConversion
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
  std::optional<modeldesc::Unit> unit;  ///< has no base unit if the file does not define the unit
  std::vector<modeldesc::EnumerationItem> items;
  std::string place;
};

/// An end of a connection. `element` is empty for a connector of the enclosing system.
struct ConnectionEnd {
  std::string element;
  std::string connector;     ///< name of the connector, with the indices of an array element, such as `y[2]`
  bool has_indices = false;  ///< true if the connection has startIndices or endIndices
};

/// A connection. The order of its ends does not define its direction (5.4.2).
struct Connection {
  ConnectionEnd start;
  ConnectionEnd end;
  Transformation transformation;
  std::string description;
  std::string place;
};

/// A value of a parameter binding after the parameter mapping. `name` begins with the prefix of the binding.
struct Parameter {
  std::string name;  ///< relative to the element of the binding
  Json value;
  std::string problem;  ///< reason why the value cannot be used; otherwise empty
  std::optional<modeldesc::Unit> unit;
  Transformation transformation;
  std::string file;  ///< file of the value, for messages
  std::string place;
};

/// An element of a system: an FMU (component) or a nested system.
struct Element {
  enum class Kind { component, system };

  Kind kind = Kind::component;
  std::string name;
  std::string description;
  std::vector<Connector> connectors;
  std::vector<Parameter> parameters;  ///< values of all bindings; later values take precedence
  std::string place;
  // For components only.
  std::filesystem::path fmu;
  bool in_own_process = false;  ///< true if the FMU was to run through a proxy
  std::string fmu_kind;         ///< kind of simulation as in a config; empty if any kind is permitted
  // For systems only.
  std::vector<Element> elements;
  std::vector<Connection> connections;
};

/// The change of a value by a chain of connections: factor * value + offset, or a map of values.
class Course {
 public:
  /// `unit` is the unit of the value before the first connection, if known. If `difference` is true, offsets of units
  /// are ignored, because the value is a difference (relativeQuantity).
  explicit Course(std::optional<modeldesc::Unit> unit, bool difference = false)
      : unit_(std::move(unit)), difference_(difference) {}

  /// Continues the chain with a connection that ends at a connector with the unit `unit`. Converts the value to `unit`,
  /// if any, and then applies the transformation (SSP 2.0, 4.5.2.1). Throws InputError with the place of the
  /// transformation if this is not possible.
  void pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit);

  double factor() const { return factor_; }
  double offset() const { return offset_; }
  const std::optional<ValueMap>& map() const { return map_; }
  const std::optional<modeldesc::Unit>& unit() const { return unit_; }
  bool converts_units() const { return converts_units_; }
  /// True if one of the unit conversions of the chain has an offset, such as from Celsius to kelvin.
  bool shifts_units() const { return shifts_units_; }
  /// Returns the changed value. Throws InputError if it cannot be changed; the message begins with `name`.
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
