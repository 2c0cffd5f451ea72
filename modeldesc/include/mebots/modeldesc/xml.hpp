// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <pugixml.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// Reads a modelDescription.xml of FMI 1.0, 2.0 or 3.0. Throws mebots::Error naming file, line, element, attribute and
/// value.
ModelDescription read_xml(const std::filesystem::path& file);

/// The same from text; `source` names it in messages.
ModelDescription read_xml_text(std::string_view text, std::string_view source);

/// The text of a modelDescription.xml. Same description, same bytes.
std::string write_xml(const ModelDescription& description);

/// Elements deeper than this are refused: no format that we read needs more, and whoever walks one may recurse.
inline constexpr int kDeepestXml = 200;

/// The text as UTF-8 without byte order mark, whatever its mark or its XML declaration says: UTF-16, UTF-32, ISO
/// 8859-1, Windows-1252 and whatever else iconv knows. Throws Error naming `source` for an unknown encoding, or bytes
/// that are none of it.
std::string xml_as_utf8(std::string_view bytes, std::string_view source);

/// Parses UTF-8 text. Nothing outside of it is ever loaded. Throws Error naming `source` and line for text that is
/// not well-formed, for a use of an entity of the DTD (it could multiply, or fetch files). Also for elements nested
/// deeper than kDeepestXml.
void parse_xml(pugi::xml_document& document, std::string_view text, std::string_view source);

/// The words of an attribute that is a list: separated by white space.
std::vector<std::string> words_of(std::string_view text);

/// The first character that XML 1.0 (section 2.2) cannot hold, not even as a reference. `text` is valid UTF-8.
std::optional<std::uint32_t> first_no_xml_character(std::string_view text);

/// Line of an offset, from 1.
std::ptrdiff_t line_of(std::string_view text, std::ptrdiff_t offset);

}  // namespace mebots::modeldesc
