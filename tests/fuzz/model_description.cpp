// SPDX-License-Identifier: Apache-2.0
//
// Reads any text as a modelDescription.xml. The reader must throw Error, or return a description whose indices of
// variables are valid. The checks of `mebots check` must not crash.
#include "checks.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include "require.hpp"

#include <cstdint>
#include <string>

namespace {

void check_all(const mebots::modeldesc::ModelDescription& model) {
  using namespace mebots::check;
  Check check;
  check_head(model, "/nowhere", check);
  check_names(model, check);
  check_variables(model, check);
  check_units_and_types(model, check);
  check_aliases(model, check);
  check_structure(model, check);
  check_osmp(model, check);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mebots::fuzz::require;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  mebots::check::Check schema;
  mebots::check::check_schema(text, schema);
  try {
    const auto model = mebots::modeldesc::read_xml_text(text, "modelDescription.xml");
    for (const auto& unknown : model.outputs)
      require(unknown.variable < model.variables.size(), "an output is a variable");
    for (const auto& variable : model.variables)
      require(!variable.derivative_of || *variable.derivative_of < model.variables.size(), "a state is a variable");
    check_all(model);
  } catch (const mebots::Error&) {
  }
  return 0;
}
