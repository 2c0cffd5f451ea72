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

/// Reads a modelDescription.xml of FMI 1.0, 2.0 or 3.0. Throws a mebots::Error that names file, line, element,
/// attribute and value.
ModelDescription read_xml(const std::filesystem::path& file);

/// Reads the text of a modelDescription.xml. `source` is the text's file name in messages. Throws the same errors as
/// read_xml().
ModelDescription read_xml_text(std::string_view text, std::string_view source);

/// Returns the text of a modelDescription.xml. Equal descriptions give equal bytes.
std::string write_xml(const ModelDescription& description);

/// The greatest permitted depth of nested elements. Deeper texts are rejected, because readers may be recursive.
inline constexpr int kDeepestXml = 200;

/// Converts `bytes` to UTF-8 without byte order mark. The byte order mark or the XML declaration determines the
/// encoding: UTF-16, UTF-32, ISO 8859-1, Windows-1252 or any other that iconv supports. Throws an Error that names
/// `source` if the encoding is unknown, or if bytes are invalid in this encoding.
std::string xml_as_utf8(std::string_view bytes, std::string_view source);

/// Parses UTF-8 text. Never loads other files. Throws Error with `source` and line if the text is not well-formed or
/// nests elements deeper than kDeepestXml. Also throws if the text uses an entity of the DTD, which could expand to a
/// very long text or load a file.
void parse_xml(pugi::xml_document& document, std::string_view text, std::string_view source);

/// Splits an attribute value at white space.
std::vector<std::string> words_of(std::string_view text);

/// Returns the first character that XML 1.0 (section 2.2) cannot represent, not even as a reference; empty if all
/// characters can be represented. `text` must be valid UTF-8.
std::optional<std::uint32_t> first_no_xml_character(std::string_view text);

/// Returns the number of the line that contains the byte at `offset`, from 1.
std::ptrdiff_t line_of(std::string_view text, std::ptrdiff_t offset);

}  // namespace mebots::modeldesc
