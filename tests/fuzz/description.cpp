// SPDX-License-Identifier: Apache-2.0
//
// Any text as a description.json: refused with an Error, or a description whose modelDescription.xml says the same when
// it is read back.
#include "description.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "memory_file.hpp"

namespace {

using namespace mebots;

void look_at(const modeldesc::Description& description) {
  const auto model = to_model_description(description);
  write_html(model);
  variables_header(description);
  binding_header(description);
  variable_table_source(description, model.guid);
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
