// SPDX-License-Identifier: Apache-2.0
#include "generate.hpp"

#include "generate_cpp.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "write_text_file.hpp"

#include <fmt/format.h>

namespace mebots::modeldesc {
void generate(const Description& description, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  const ModelDescription model = to_model_description(description);
  write_text_file(folder / "modelDescription.xml", write_xml(model));
  write_text_file(folder / "index.html", write_html(model));
  write_text_file(folder / "variables.hpp", variables_header(description));
  write_text_file(folder / "binding.hpp", binding_header(description));
  write_text_file(folder / "variable_table.cpp", variable_table_source(description, model.guid));
}

}  // namespace mebots::modeldesc
