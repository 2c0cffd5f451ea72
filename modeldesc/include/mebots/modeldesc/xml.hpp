// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::modeldesc {

/// Reads a modelDescription.xml of FMI 2.0. Throws mebots::Error naming file, line, element, attribute and value.
ModelDescription read_xml(const std::filesystem::path& file);

/// The same from text; `source` names it in messages.
ModelDescription read_xml_text(std::string_view text, std::string_view source);

/// The text of a modelDescription.xml. Same description, same bytes.
std::string write_xml(const ModelDescription& description);

}  // namespace mebots::modeldesc
