// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <string>

namespace mebots::modeldesc {

/// The modelDescription.xml of a description as plain data, GUID included: the GUID is made from the content, so
/// that the same description always has the same one and a changed description another.
ModelDescription to_model_description(const Description& description);

/// A page about the FMU for people: what it is and its variables.
std::string write_html(const ModelDescription& description);

/// Writes modelDescription.xml, index.html, variables.hpp, binding.hpp and variable_table.cpp into `folder`.
void generate(const Description& description, const std::filesystem::path& folder);

}  // namespace mebots::modeldesc
