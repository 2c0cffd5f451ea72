// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "network.hpp"
#include "xml_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master::ssp {

/// The start value of an endpoint, in the endpoint's unit, and the place that defines it.
struct StartingValue {
  Json value;
  std::optional<modeldesc::Unit> unit;
  std::string file;
  std::string place;
};

/// Collects notices about values. Combines notices that have the same file and text into one, which lists the
/// variables.
class ValueNotices {
 public:
  void add(const std::string& file, const std::string& text, const std::string& name);
  /// Returns texts such as "FILE: TEXT (3): a, b, c".
  std::vector<std::string> texts() const;

 private:
  using FileAndText = std::pair<std::string, std::string>;

  std::vector<FileAndText> order_;
  std::map<FileAndText, std::vector<std::string>> names_;
};

/// Returns the values of all parameter bindings. Outer bindings override inner ones, and later bindings override
/// earlier ones (SSP 2.0, 5.3.3). Leaves out names that have no endpoint, and variables that cannot be set. Throws
/// InputError if the unit of a value does not match, or if the value cannot be transformed.
std::map<Endpoint, StartingValue> starting_values(const Network& network, ValueNotices& notices);

/// Converts a value to the type of the variable: a Real that is a whole number becomes an Integer.
Json fitting(Json value, const Port& port);

/// Converts the number to an integer. Returns nullopt if the number is not whole, or so large that a double cannot
/// represent all whole numbers of its magnitude.
std::optional<std::int64_t> exact_whole(double number);

/// The files and definitions to which the bindings of an element may refer.
struct BindingContext {
  const Source& source;
  const XmlFile& ssd;
  const Definitions& definitions;  ///< definitions of the SSD
  std::filesystem::path fmu;       ///< path of a component's FMU; paths with sourceBase="component" are relative to it
};

/// Reads all values in the <ParameterBindings> of an element (SSP 2.0, 5.3.3), in the order of the file. An SSV or SSM
/// may be inline or a separate file.
std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element);

}  // namespace mebots::master::ssp
