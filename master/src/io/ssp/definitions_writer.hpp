// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>

namespace mebots::master::ssp {

/// Collects the <Units> and <Enumerations> that the variables of one written file use.
class DefinitionsWriter {
 public:
  /// Returns the unit name that is to be written for a variable. Returns an empty text if the variable's FMU does not
  /// define the unit, or if another FMU defines a unit of the same name differently. `model` must outlive this object.
  std::string unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);
  void add_enumeration(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);

  /// Appends the sections <Units> and <Enumerations>, unless they are empty. `prefix` is the XML prefix of their names,
  /// as in "ssd:Units".
  void write(pugi::xml_node root, const std::string& prefix) const;

 private:
  std::map<std::string, const modeldesc::TypeDefinition*> enumerations_;
  std::map<std::string, const modeldesc::Unit*> units_;
};

/// Returns the SSP version in which this system is written. It is 2.0 if one of its FMUs is of FMI 3.0, because SSP 1.0
/// lacks the types of FMI 3.0. Otherwise, it is 1.0.
const char* written_version(const ResolvedSystem& system);

/// Writes the values of an instance, and the units of its FMU, into an SSV document. An array is written as a whole:
/// elements without a value in the system have their start value. Throws InputError if the FMU declares no start value.
void write_parameter_set(const ResolvedInstance& instance, const char* version, pugi::xml_document& document);

}  // namespace mebots::master::ssp
