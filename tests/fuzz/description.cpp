// SPDX-License-Identifier: Apache-2.0
//
// Reads any text as a description.json. The reader must throw Error, or return a description. The modelDescription.xml
// that is written for this description must contain all its variables.
#include "description.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "memory_file.hpp"
#include "require.hpp"

namespace {

using namespace mebots;

/// Writes the files for FMI 3.0, and returns the instantiation token. If an array has the name of another variable,
/// which FMI 3.0 forbids, returns an empty text.
std::string fmi3_token(const modeldesc::Description& description, const modeldesc::ModelDescription& model) {
  try {
    const auto text = write_fmi3_xml(description, model);
    write_fmi3_html(description, model);
    pugi::xml_document document;
    modeldesc::parse_xml(document, text.xml, "written");
    const auto terminals = write_terminals_and_icons(description, false);
    if (!terminals.empty()) modeldesc::parse_xml(document, terminals, "written");
    return text.token;
  } catch (const Error& error) {
    fuzz::require(error.code() == ErrorCode::duplicate_name, error.what());
    return {};
  }
}

void look_at(const modeldesc::Description& description) {
  const auto model = to_model_description(description);
  write_html(model);
  variables_header(description);
  binding_header(description);
  variable_table_source(description, model.guid, fmi3_token(description, model));
  const auto again = modeldesc::read_xml_text(write_xml(model), "written");
  fuzz::require(again.variables.size() == model.variables.size(), "all variables are in the XML");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  std::optional<modeldesc::Description> description;
  try {
    description = modeldesc::read_description(file.with(data, size));
  } catch (const Error&) {
  }
  if (description) look_at(*description);
  return 0;
}
