// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/resolved_system.hpp"

#include <pugixml.hpp>

#include <map>
#include <string>

namespace mebots::master::ssp {

/// <Units> and <Enumerations> of one file: what its variables refer to.
class DefinitionsWriter {
 public:
  /// The name to write for a variable's unit; empty for one that its FMU does not define, or that another FMU defines
  /// otherwise. `model` must outlive this object.
  std::string unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);
  void add_enumeration(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable);

  /// Appends the sections that are not empty, with names such as "ssd:Units".
  void write(pugi::xml_node root, const std::string& prefix) const;

 private:
  std::map<std::string, const modeldesc::TypeDefinition*> enumerations_;
  std::map<std::string, const modeldesc::Unit*> units_;
};

/// Version of the files that are written.
inline constexpr const char* kWrittenVersion = "1.0";

/// Fills an SSV file with the start values of an instance, with the units of its FMU.
void write_parameter_set(const ResolvedInstance& instance, pugi::xml_document& document);

}  // namespace mebots::master::ssp
