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

/// Declares the content of an SSP as plain data: the SSD, and the SSV and SSM files to which it refers. FMUs are not
/// read. Section numbers refer to SSP 2.0, https://ssp-standard.org.
namespace mebots::master::ssp {

using Json = nlohmann::ordered_json;

/// The <Units> and <Enumerations> of one file. They are valid only in this file (4.4.1).
struct Definitions {
  std::map<std::string, modeldesc::Unit, std::less<>> units;
  std::map<std::string, std::vector<modeldesc::EnumerationItem>, std::less<>> enumerations;
};

/// An SSP LinearTransformation: factor * value + offset, applied after the conversion of units (4.5.2.1).
struct Linear {
  double factor = 1;
  double offset = 0;
};

/// An SSP BooleanMappingTransformation, IntegerMappingTransformation or EnumerationMappingTransformation. A value that
/// has no entry does not change (4.5.2.2).
struct ValueMap {
  enum class Kind { boolean, integer, enumeration };

  Kind kind = Kind::integer;
  std::vector<std::pair<std::string, std::string>> entries;  ///< pairs of source and target, as written in the file
};

/// Describes how a connection or a parameter mapping changes a value. `what` is empty if the value does not change.
struct Transformation {
  std::variant<std::monostate, Linear, ValueMap> what;
  bool convert_units = true;  ///< false if the element has the attribute suppressUnitConversion
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
  std::optional<modeldesc::Unit> unit;  ///< has no base if the file does not define the unit
  std::vector<modeldesc::EnumerationItem> items;
  std::string place;
};

/// One end of a connection. `element` is empty if the connector belongs to the enclosing system.
struct ConnectionEnd {
  std::string element;
  std::string connector;     ///< name of the connector; for an element of an array with the indices, as in `y[2]`
  bool has_indices = false;  ///< true if the connection has startIndices or endIndices
};

/// A connection between two ends. The order of the ends does not define the direction (5.4.2).
struct Connection {
  ConnectionEnd start;
  ConnectionEnd end;
  Transformation transformation;
  std::string description;
  std::string place;
};

/// A value from a parameter binding. Its name includes the prefix, and the parameter mapping has already been applied.
struct Parameter {
  std::string name;  ///< name relative to the element that has the binding
  Json value;
  std::string problem;  ///< why the value cannot be used; empty if it can be used
  std::optional<modeldesc::Unit> unit;
  Transformation transformation;
  std::string file;  ///< name of the file that contains the value, for messages
  std::string place;
};

/// An element of a system: a component (an FMU) or a nested system.
struct Element {
  enum class Kind { component, system };

  Kind kind = Kind::component;
  std::string name;
  std::string description;
  std::vector<Connector> connectors;
  std::vector<Parameter> parameters;  ///< values of all bindings, in their order; later values take precedence
  std::string place;
  // Members that only a component has.
  std::filesystem::path fmu;
  bool in_own_process = false;  ///< true if the FMU was intended to run through a proxy
  std::string fmu_kind;         ///< kind of simulation in the notation of a config; empty if any kind is permitted
  // Members that only a system has.
  std::vector<Element> elements;
  std::vector<Connection> connections;
};

/// Describes how a chain of connections changes a value: by factor * value + offset, or by a map of values.
class Course {
 public:
  /// `unit` is the unit of the value at the start of the chain, if known. If `difference` is true, the value is a
  /// difference of two values (relativeQuantity). In this case, offsets of units are not applied.
  explicit Course(std::optional<modeldesc::Unit> unit, bool difference = false)
      : unit_(std::move(unit)), difference_(difference) {}

  /// Appends a connection that ends at a connector with the unit `unit`. If `unit` is not empty, the value is first
  /// converted to it. After that, the transformation is applied (SSP 2.0, 4.5.2.1). Throws InputError with the place of
  /// the transformation if the conversion is not possible.
  void pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit);

  double factor() const { return factor_; }
  double offset() const { return offset_; }
  const std::optional<ValueMap>& map() const { return map_; }
  const std::optional<modeldesc::Unit>& unit() const { return unit_; }
  bool converts_units() const { return converts_units_; }
  /// True if the chain contains a conversion of units that has an offset, as from Celsius to kelvin.
  bool shifts_units() const { return shifts_units_; }
  /// Applies the changes to a value and returns the result. If this is not possible, throws InputError whose message
  /// begins with `name`.
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
