// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "network.hpp"
#include "xml_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master::ssp {

/// The start value of an endpoint in the endpoint's unit, and the place of its definition.
struct StartingValue {
  Json value;
  std::optional<modeldesc::Unit> unit;
  std::string file;
  std::string place;
};

/// Collects notices about values. Notices with the same file and text become one notice with all variables.
class ValueNotices {
 public:
  void add(const std::string& file, const std::string& text, const std::string& name);
  /// Returns notices such as "FILE: TEXT (3): a, b, c".
  std::vector<std::string> texts() const;

 private:
  using FileAndText = std::pair<std::string, std::string>;

  std::vector<FileAndText> order_;
  std::map<FileAndText, std::vector<std::string>> names_;
};

/// Returns the values of all parameter bindings. Outer bindings override inner ones, and later bindings override
/// earlier ones (SSP 2.0, 5.3.3). Omits names without an endpoint, and variables that cannot be set. Throws InputError
/// if a value has a wrong unit or cannot be transformed.
std::map<Endpoint, StartingValue> starting_values(const Network& network, ValueNotices& notices);

/// Converts a value to the type of the variable. For an Integer, a whole number such as 2.0 becomes 2.
Json fitting(Json value, const Port& port);

/// Converts a number to an integer. Returns nullopt if the number is not whole, or so large that not every whole number
/// of its magnitude is a double.
std::optional<std::int64_t> exact_whole(double number);

struct BindingContext {
  const Source& source;
  const XmlFile& ssd;
  const Definitions& definitions;  ///< of the SSD
  std::filesystem::path fmu;       ///< path of the component's FMU; base of paths with sourceBase="component"
};

/// Reads the values in the <ParameterBindings> of an element (SSP 2.0, 5.3.3), in the order of the file. An SSV or SSM
/// may be inline or a separate file.
std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element);

}  // namespace mebots::master::ssp
