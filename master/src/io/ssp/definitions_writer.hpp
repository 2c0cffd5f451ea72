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
  /// Returns the unit name to write for a variable. Empty if the variable's FMU does not define the unit, or if another
  /// FMU defines the same name differently. `model` must outlive this object.
  std::string unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);
  void add_enumeration(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);

  /// Appends the sections that are not empty. `prefix` is the XML prefix of their names, as in "ssd:Units".
  void write(pugi::xml_node root, const std::string& prefix) const;

 private:
  std::map<std::string, const modeldesc::TypeDefinition*> enumerations_;
  std::map<std::string, const modeldesc::Unit*> units_;
};

/// Returns the SSP version of the files for this system: 2.0 if an FMU is of FMI 3.0, whose types 1.0 lacks; else 1.0.
const char* written_version(const ResolvedSystem& system);

/// Fills an SSV file with the values of an instance and the units of its FMU. An array is written as a whole: elements
/// without a value in the system get their start value. Throws InputError if the FMU declares none.
void write_parameter_set(const ResolvedInstance& instance, const char* version, pugi::xml_document& document);

}  // namespace mebots::master::ssp
