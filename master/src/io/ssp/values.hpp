// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "network.hpp"
#include "xml_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master::ssp {

/// A value that an endpoint has before the run, in the endpoint's unit.
struct StartingValue {
  Json value;
  std::optional<modeldesc::Unit> unit;
  std::string file;
  std::string place;
};

/// Notices about values: one for each file and text, with the names of the variables.
class ValueNotices {
 public:
  void add(const std::string& file, const std::string& text, const std::string& name);
  /// "FILE: TEXT (3): a, b, c"
  std::vector<std::string> texts() const;

 private:
  using FileAndText = std::pair<std::string, std::string>;

  std::vector<FileAndText> order_;
  std::map<FileAndText, std::vector<std::string>> names_;
};

/// The values of all parameter bindings: outer ones win over inner ones, later ones over earlier ones (SSP 2.0, 5.3.3).
/// A name that nothing has, and a variable that takes no value, are left out. Throws InputError for a value whose unit
/// does not fit, or that cannot be transformed.
std::map<Endpoint, StartingValue> starting_values(const Network& network, ValueNotices& notices);

/// A value as a variable of this type takes it: whole numbers of type Real become Integers.
Json fitting(Json value, const Port& port);

/// Files and definitions that the bindings of an element may refer to.
struct BindingContext {
  const Source& source;
  const XmlFile& ssd;
  const Definitions& definitions;  ///< of the SSD
  std::filesystem::path fmu;       ///< of a component: sourceBase="component" begins in it
};

/// All values of an element's <ParameterBindings> (SSP 2.0, 5.3.3), SSV and SSM inline or in files, in their order.
std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element);

}  // namespace mebots::master::ssp
