// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>

namespace mebots::master::ssp {

/// Collects the <Units> and <Enumerations> of a file.
class DefinitionsWriter {
 public:
  /// Returns the name of a variable's unit in the file. Returns an empty text if the FMU does not define the unit, or
  /// if another FMU defines a different unit with this name. `model` must outlive this object.
  std::string unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);
  void add_enumeration(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);

  /// Appends <Units> and <Enumerations>, unless they are empty. `prefix` is their XML prefix, such as "ssd:".
  void write(pugi::xml_node root, const std::string& prefix) const;

 private:
  std::map<std::string, const modeldesc::TypeDefinition*> enumerations_;
  std::map<std::string, const modeldesc::Unit*> units_;
};

/// Returns the SSP version for a system: 2.0 if it contains an FMU of FMI 3.0, whose types do not exist in SSP 1.0;
/// otherwise 1.0.
const char* written_version(const ResolvedSystem& system);

/// Writes the values of an instance and the units of its FMU into an SSV document. Arrays are written as a whole.
/// Elements without a value receive their start value. Throws InputError if an element has no start value.
void write_parameter_set(const ResolvedInstance& instance, const char* version, pugi::xml_document& document);

}  // namespace mebots::master::ssp
