// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "network.hpp"
#include "xml_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master::ssp {

/// The start value of an endpoint, in the endpoint's unit.
struct StartingValue {
  Json value;
  std::optional<modeldesc::Unit> unit;
  std::string file;
  std::string place;
};

/// Collects notices about values. Notices with the same file and text are combined, with a list of the variables.
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

/// Returns the values of all parameter bindings. Outer bindings override inner bindings, and later bindings override
/// earlier ones (SSP 2.0, 5.3.3). Leaves out names without an endpoint, and variables that cannot be set. Throws
/// InputError if a value's unit does not fit or the value cannot be transformed.
std::map<Endpoint, StartingValue> starting_values(const Network& network, ValueNotices& notices);

/// Converts a value to the type of the variable: whole numbers of type Real become Integers.
Json fitting(Json value, const Port& port);

/// Returns the number as a whole number; empty if it is not whole, or so large that doubles do not hold all whole
/// numbers.
std::optional<std::int64_t> exact_whole(double number);

/// The files and definitions to which an element's bindings may refer.
struct BindingContext {
  const Source& source;
  const XmlFile& ssd;
  const Definitions& definitions;  ///< of the SSD
  std::filesystem::path fmu;       ///< of a component: paths with sourceBase="component" are relative to it
};

/// Reads all values in an element's <ParameterBindings> (SSP 2.0, 5.3.3), in the order of the file. The SSV and SSM may
/// be inline or separate files.
std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element);

}  // namespace mebots::master::ssp
