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

/// The content of an SSP as plain data: its SSD with the SSV and SSM files to which it refers. Reads no FMU. Section
/// numbers are those of SSP 2.0, https://ssp-standard.org.
namespace mebots::master::ssp {

using Json = nlohmann::ordered_json;

/// The <Units> and <Enumerations> of one file, by name. These definitions are valid in their file only (4.4.1).
struct Definitions {
  std::map<std::string, modeldesc::Unit, std::less<>> units;
  std::map<std::string, std::vector<modeldesc::EnumerationItem>, std::less<>> enumerations;
};

/// An SSP LinearTransformation: factor * value + offset, applied after the conversion of units (4.5.2.1).
struct Linear {
  double factor = 1;
  double offset = 0;
};

/// An SSP BooleanMappingTransformation, IntegerMappingTransformation or EnumerationMappingTransformation. A value
/// without an entry does not change (4.5.2.2).
struct ValueMap {
  enum class Kind { boolean, integer, enumeration };

  Kind kind = Kind::integer;
  std::vector<std::pair<std::string, std::string>> entries;  ///< source and target, as written
};

/// A change of the value by a connection or a parameter mapping; empty for no change.
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
  std::optional<modeldesc::Unit> unit;  ///< without a base if the file does not define it
  std::vector<modeldesc::EnumerationItem> items;
  std::string place;
};

/// An end of a connection. `element` is empty for a connector of the enclosing system.
struct ConnectionEnd {
  std::string element;
  std::string connector;     ///< for an element of an array, with its indices: `y[2]`
  bool has_indices = false;  ///< startIndices or endIndices
};

/// A connection between two ends. The order of the ends does not define the direction (5.4.2).
struct Connection {
  ConnectionEnd start;
  ConnectionEnd end;
  Transformation transformation;
  std::string description;
  std::string place;
};

/// A value from a parameter binding. Its name includes the prefix and is already changed by the parameter mapping.
struct Parameter {
  std::string name;  ///< relative to the element that has the binding
  Json value;
  std::string problem;  ///< why the value cannot be used; empty if it can
  std::optional<modeldesc::Unit> unit;
  Transformation transformation;
  std::string file;  ///< the file with the value, as named in messages
  std::string place;
};

/// An element of a system: a component (an FMU) or a nested system.
struct Element {
  enum class Kind { component, system };

  Kind kind = Kind::component;
  std::string name;
  std::string description;
  std::vector<Connector> connectors;
  std::vector<Parameter> parameters;  ///< of all bindings in order; later ones take precedence
  std::string place;
  // Members that only a component has.
  std::filesystem::path fmu;
  bool in_own_process = false;  ///< it was meant to run through a proxy
  std::string fmu_kind;         ///< in the notation of a config; empty = any
  // Members that only a system has.
  std::vector<Element> elements;
  std::vector<Connection> connections;
};

/// The change of a value along a chain of connections: either factor * value + offset, or a map of values.
class Course {
 public:
  /// `unit` is the unit of the value before the conversion, or empty. If `difference` is true, the value is a
  /// difference of two values (relativeQuantity), so that a unit's offset does not apply.
  explicit Course(std::optional<modeldesc::Unit> unit, bool difference = false)
      : unit_(std::move(unit)), difference_(difference) {}

  /// Appends a connection to a connector. If `unit` is not empty, first converts the value to this unit. Then
  /// transforms the value (SSP 2.0, 4.5.2.1). Throws InputError with the transformation's place.
  void pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit);

  double factor() const { return factor_; }
  double offset() const { return offset_; }
  const std::optional<ValueMap>& map() const { return map_; }
  const std::optional<modeldesc::Unit>& unit() const { return unit_; }
  bool converts_units() const { return converts_units_; }
  /// True if a conversion of units has an offset, as from Celsius to kelvin.
  bool shifts_units() const { return shifts_units_; }
  /// Returns the changed value. Throws InputError with a message that begins with `name` if this change is not
  /// possible.
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
